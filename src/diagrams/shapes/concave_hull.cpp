// Concave hulls by edge length (Duckham, Kulik, Worboys, Galton 2008: chi-shapes).
#include <algorithm>
#include <cmath>
#include <numeric>
#include <queue>
#include <span>
#include <utility>
#include <vector>

#include "cullhull/alpha_shape.hpp"
#include "cullhull/error.hpp"
#include "delaunay/write_triangulation.hpp"
#include "diagrams/dual.hpp"
#include "diagrams/memory_needs.hpp"
#include "exact/orientation/difference_products.hpp"
#include "parallel/index.hpp"

namespace cullhull::internal {
namespace {

void require_plane(const Triangulation& t) {
  require_unweighted(t, "concave hulls");
  if (t.corners() > 3)
    throw Error(ErrorCode::invalid_argument,
                "concave hulls by the length of edges are of points in a plane");
}

void require_length(double length) {
  if (!(length >= 0))
    throw Error(ErrorCode::invalid_argument,
                "the length of edges must be a number that is not negative");
}

Edge edge_of(std::uint32_t a, std::uint32_t b) { return {std::min(a, b), std::max(a, b)}; }

/// Compares edges by length, exactly; of equal edges the lexicographically lower counts as longer.
class Lengths {
 public:
  Lengths(const DualPoints& p, unsigned d) : p_(p), d_(d), none_(d), limit_(d) {}

  bool longer(const Edge& a, const Edge& b) const {
    const Sign sign =
        compare_lengths(d_, p_.row(a.low), p_.row(a.high), p_.row(b.low), p_.row(b.high));
    if (sign != Sign::zero) return sign == Sign::positive;
    return a < b;
  }
  void set_limit(double limit) { limit_[0] = limit; }
  bool over_limit(const Edge& e) const {
    return compare_lengths(d_, p_.row(e.low), p_.row(e.high), limit_.data(), none_.data()) ==
           Sign::positive;
  }
  /// The length in floating point, with a few roundings; scaled so that squares neither overflow
  /// nor underflow.
  double rounded(const Edge& e) const {
    double widest = 0;
    for (unsigned j = 0; j < d_; ++j)
      widest = std::max(widest, std::abs(p_.row(e.high)[j] / 2 - p_.row(e.low)[j] / 2));
    if (widest == 0) return 0;
    double sum = 0;
    for (unsigned j = 0; j < d_; ++j) {
      const double x = (p_.row(e.high)[j] / 2 - p_.row(e.low)[j] / 2) / widest;
      sum += x * x;
    }
    return 2 * widest * std::sqrt(sum);
  }

 private:
  const DualPoints& p_;
  unsigned d_;
  std::vector<double> none_, limit_;
};

/// Removes triangles at the boundary, those with the longest boundary edge first.
class Digging {
 public:
  Digging(const Triangulation& t, const Lengths& lengths)
      : t_(t), lengths_(lengths), kept_(t.size()), outside_(t.point_count), queue_(Later{lengths}) {
    std::fill(kept_.begin(), kept_.end(), std::uint8_t{1});
    std::fill(outside_.begin(), outside_.end(), std::uint8_t{0});
    for (const std::uint32_t v : t.hull_facets) outside_[v] = 1;
    for (std::uint32_t c = 0; c < t.size(); ++c)
      for (unsigned j = 0; j < 3; ++j)
        if (t.neighbours_of(c)[j] == no_index) add(c, j);
  }

  Array<std::uint8_t> run(const Run& run) {
    for (std::uint64_t step = 0; !queue_.empty(); ++step) {
      if (step % 4096 == 0) run.check();
      const Side side = queue_.top();
      queue_.pop();
      const std::uint32_t apex = t_.cell(side.cell)[side.corner];
      // Otherwise the boundary would touch itself or lose a point. Points on the boundary stay on
      // it.
      if (kept_[side.cell] == 0 || outside_[apex] != 0) continue;
      outside_[apex] = 1;
      kept_[side.cell] = 0;
      for (unsigned j = 0; j < 3; ++j) {
        const std::uint32_t o = t_.neighbours_of(side.cell)[j];
        if (o == no_index || kept_[o] == 0) continue;
        const unsigned corner = place_in(t_.neighbours_of(o), side.cell);
        if (corner == 3) bad_neighbours();
        add(o, corner);
      }
    }
    return std::move(kept_);
  }

 private:
  /// A boundary edge of a triangle.
  struct Side {
    Edge edge;
    std::uint32_t cell;
    unsigned corner;
  };
  struct Later {
    const Lengths& lengths;
    bool operator()(const Side& a, const Side& b) const { return lengths.longer(b.edge, a.edge); }
  };

  void add(std::uint32_t cell, unsigned corner) {
    const auto ids = t_.cell(cell);
    const Edge edge = edge_of(ids[(corner + 1) % 3], ids[(corner + 2) % 3]);
    if (lengths_.over_limit(edge)) queue_.push({edge, cell, corner});
  }

  const Triangulation& t_;
  const Lengths& lengths_;
  Array<std::uint8_t> kept_, outside_;
  std::priority_queue<Side, std::vector<Side>, Later> queue_;
};

}  // namespace
}  // namespace cullhull::internal

namespace cullhull {

using namespace internal;

AlphaShape concave_hull(const PointView& points, const Triangulation& triangulation, double length,
                        const RunOptions& options) {
  const Triangulation& t = triangulation;
  require_length(length);
  require_plane(t);
  const Call call(options);
  const Run& run = call.run;
  begin_step(run, shape_bytes(t.point_count, t.size(), t.dimension), "the cells of the shape");
  const DualPoints p(points, t, {}, run);
  Array<std::uint8_t> kept(t.size());
  std::fill(kept.begin(), kept.end(), std::uint8_t{1});
  if (t.corners() == 3 && !std::isinf(length)) {
    Lengths lengths(p, t.dimension);
    lengths.set_limit(length);
    kept = Digging(t, lengths).run(run);
  }
  AlphaShape out;
  for (std::uint32_t c = 0; c < t.size(); ++c)
    if (kept[c] != 0) out.cells.push_back(c);
  write_boundary(t, kept.data(), out.facets, out.facet_cells, run);
  return out;
}

Triangulation without_long_edges(const PointView& points, Triangulation triangulation,
                                 double length, const RunOptions& options) {
  Triangulation& t = triangulation;
  require_length(length);
  const Call call(options);
  const Run& run = call.run;
  const DualPoints p(points, t, {}, run);
  const unsigned corners = t.corners();
  if (corners < 2 || std::isinf(length)) return triangulation;
  Lengths lengths(p, t.dimension);
  lengths.set_limit(length);
  std::vector<std::uint8_t> kept(t.size(), 1);
  for (std::uint32_t c = 0; c < t.size(); ++c) {
    if (c % 4096 == 0) run.check();
    const auto ids = t.cell(c);
    for (unsigned i = 0; i < corners; ++i)
      for (unsigned j = i + 1; j < corners; ++j)
        if (lengths.over_limit(edge_of(ids[i], ids[j]))) kept[c] = 0;
  }
  keep_cells(t, kept.data());
  write_boundary(t, nullptr, t.hull_facets, t.hull_cells, run);
  return triangulation;
}

namespace {

/// The rest of a vector beside unit vectors that are orthogonal to one another.
void leave_orthogonal(double* own, const double* units, std::size_t count, std::size_t d) {
  for (std::size_t b = 0; b < count; ++b, units += d) {
    const double part = std::inner_product(own, own + d, units, 0.0);
    for (std::size_t j = 0; j < d; ++j) own[j] -= part * units[j];
  }
}

/// The product of the lengths that the rows have beside those before. `edges`: k rows of d numbers,
/// overwritten.
double orthogonal_product(double* edges, std::size_t k, std::size_t d) {
  if (k == 2 && d == 2) return std::abs(edges[0] * edges[3] - edges[1] * edges[2]);
  if (k >= 2 && d == 3) {
    const double* const e = edges;
    const double cross[] = {e[1] * e[5] - e[2] * e[4], e[2] * e[3] - e[0] * e[5],
                            e[0] * e[4] - e[1] * e[3]};
    return k == 2 ? std::hypot(cross[0], cross[1], cross[2])
                  : std::abs(std::inner_product(e + 6, e + 9, cross, 0.0));
  }
  double product = 1;
  for (std::size_t a = 0; a < k; ++a) {
    double* const own = edges + a * d;
    leave_orthogonal(own, edges, a, d);
    const double length = std::sqrt(std::inner_product(own, own + d, own, 0.0));
    if (length == 0) return 0;
    product *= length;
    for (std::size_t j = 0; j < d; ++j) own[j] /= length;
  }
  return product;
}

/// k! times the k-measure of k + 1 points: for small whole numbers exact, and so is a sum. The
/// edges are scaled by a power of two, so that no product overflows.
double parallelotope_measure(const PointView& points, std::span<const std::uint32_t> ids) {
  const std::size_t k = ids.size() - 1, d = points.dimension;
  std::vector<double> edges(k * d);
  double longest = 0;
  for (std::size_t i = 0; i < k * d; ++i) {
    const auto j = static_cast<std::uint32_t>(i % d);
    edges[i] = points.at(ids[1 + i / d], j) - points.at(ids[0], j);
    longest = std::max(longest, std::abs(edges[i]));
  }
  if (longest == 0) return k == 0 ? 1 : 0;
  const int scale = std::ilogb(longest);
  for (double& x : edges) x = std::ldexp(x, -scale);
  double measure = orthogonal_product(edges.data(), k, d);
  for (std::size_t i = 0; i < k; ++i) measure = std::ldexp(measure, scale);
  return measure;
}

}  // namespace

ShapeMeasures shape_measures(const PointView& points, const Triangulation& triangulation,
                             const AlphaShape& shape) {
  const Triangulation& t = triangulation;
  if (points.count != t.point_count || points.dimension != t.dimension)
    throw Error(ErrorCode::invalid_argument, "the triangulation is not that of these points");
  ShapeMeasures out;
  if (t.corners() < 2) return out;
  const std::size_t k = t.corners() - 1;
  for (const std::uint32_t c : shape.cells) out.volume += parallelotope_measure(points, t.cell(c));
  for (std::size_t at = 0; at < shape.facets.size(); at += k)
    out.boundary += parallelotope_measure(points, std::span(shape.facets).subspan(at, k));
  for (std::size_t i = 2; i <= k; ++i) {
    out.volume /= static_cast<double>(i);
    if (i < k) out.boundary /= static_cast<double>(i);
  }
  return out;
}

double concave_length(const PointView& points, const Triangulation& triangulation, double ratio,
                      const RunOptions& options) {
  const Triangulation& t = triangulation;
  if (!(ratio >= 0 && ratio <= 1))
    throw Error(ErrorCode::invalid_argument, "the ratio of lengths must be between 0 and 1");
  require_plane(t);
  const Call call(options);
  const Run& run = call.run;
  begin_step(run, shape_bytes(t.point_count, t.size(), t.dimension), "the cells of the shape");
  const DualPoints p(points, t, {}, run);
  if (ratio == 1) return INFINITY;
  if (t.corners() < 3) return 0;
  const Lengths lengths(p, t.dimension);
  double least = INFINITY, greatest = 0;
  for (std::uint32_t c = 0; c < t.size(); ++c)
    for (unsigned j = 0; j < 3; ++j) {
      const double length = lengths.rounded(edge_of(t.cell(c)[j], t.cell(c)[(j + 1) % 3]));
      least = std::min(least, length);
      greatest = std::max(greatest, length);
    }
  return std::isinf(greatest) ? greatest : least + ratio * (greatest - least);
}

}  // namespace cullhull
