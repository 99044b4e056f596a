// Checks every input point against a surface that is known to bound a convex polytope P.
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>

#include "certify/certificate.hpp"
#include "certify/hull/cones.hpp"
#include "certify/hull/inner_ball.hpp"
#include "exact/orientation/flat_test.hpp"
#include "geometry/gather.hpp"
#include "parallel/dispatch.hpp"

namespace cullhull::internal::certify {
namespace {

constexpr std::uint64_t chunk = std::uint64_t{1} << 14;  // tens of us of work

FlatTest flat_of(const Subject& s) {
  std::vector<const double*> basis;
  for (const std::uint32_t v : s.basis)
    basis.push_back(s.full.data() + std::size_t{v} * s.hull.dimension);
  return {s.hull.dimension, s.axes, basis};
}

// Scale each axis by a power of two (exact) so that P's half extents from o lie in [1/2, 1); norms
// are maximum norms, u = 2^-53, m the largest |coordinate|. Box: all corners o +- r, rounded, were
// found in P exactly; each is off by at most 2u (m + 1) < r/2, so P contains the box of radius rho
// = r/2. Nodes: the cube of directions carries a grid of nodes v (exact doubles); for each a radius
// t <= 2 such that y = o + t v, rounded, is in P exactly; |y - (o + t v)| <= eps = 2u (m + 2). Let
// t_c be the least radius among the nodes of a cell. P contains o, so the points o + t_c v of the
// cell's nodes are within eps of P, and so is o + t_c w for every w in the cell, the convex hull of
// its nodes. Since P contains the box, P + eps box within o + (1 + eps/rho)(P - o): the gauge of w
// is at most (1 + eps/rho) / t_c. Point: the differences x - o, the radius s and the quotients that
// choose the cell are each rounded once; so x is within 8 u s of o + s w with w in the chosen cell,
// and its gauge is at most s (1 + eps/rho) / t_c + 8 u s / rho. With s <= 2 this is below 1 if s <
// t_c (1 - eta), eta = 2 (eps + 16 u) / rho <= 1/8. Then x is strictly inside. Points nearer to o
// than r/4 are in the box.

/// Skips most points that are strictly inside: a grid on the cube of directions around the centre,
/// with an inner radius for each cell. docs/exactness.md, "Certificate", says what it proves.
class InnerFilter {
 public:
  InnerFilter(const Subject& s, const Cones& cones, std::uint64_t points)
      : s_(s), cones_(cones), k_(s.k) {
    if (!cones.usable() || k_ > 6) return;
    choose_resolution(points);
    for (unsigned j = 0; j < k_; ++j) scale_.push_back(cones.scale(j));
    if (resolution_ < 2 || !find_box()) return;
    probe_nodes();
  }
  bool usable() const { return !limits_.empty(); }

  /// True only if the point is strictly inside. y: relative to the centre, scaled as in Cones. Sets
  /// `hint` to a simplex near the point's ray.
  template <unsigned K>
  bool strictly_inside(const double* y, std::uint32_t& hint) const {
    double radius = 0, around[2 * K];
    unsigned face = 0;
    for (unsigned j = 0; j < K; ++j) {  // branch-free: the face is unpredictable
      const double a = std::fabs(y[j]);
      face = a > radius ? j : face;
      radius = a > radius ? a : radius;
      around[j] = around[j + K] = y[j];
    }
    if (radius < 0x1p-300) return radius < tiny_;
    const double middle = 0.5 * resolution_, half = middle / radius;
    const int last = static_cast<int>(resolution_) - 1;
    std::uint64_t cell = 2 * face + (y[face] < 0);
    for (unsigned j = 1; j < K; ++j) {
      const auto c = static_cast<int>(around[face + j] * half + middle);
      cell = cell * resolution_ + static_cast<unsigned>(std::min(c, last));
    }
    if (radius < limits_[cell]) return true;
    hint = hints_[cell];
    return false;
  }

 private:
  std::uint64_t nodes() const {
    return static_cast<std::uint64_t>(2.0 * k_ * std::pow(resolution_ + 1.0, k_ - 1.0));
  }

  /// Whether centre + t * direction, rounded, is in P. The walk starts at f and sets f to the facet
  /// reached.
  bool inside(const double* direction, double t, std::uint32_t& f, const double** scratch) const {
    double x[6];
    for (unsigned j = 0; j < k_; ++j) x[j] = s_.centre[j] + t * direction[j] / scale_[j];
    f = s_.locate(x, f, scratch);
    return s_.side(f, x, scratch) != Sign::positive;
  }

  /// Chooses the grid's resolution. Each node and each point costs one walk, whose length is
  /// inversely proportional to the resolution; at most 150,000 nodes (0.6 MB), which fit into the
  /// cache. 0: no grid, as there are too few points.
  void choose_resolution(std::uint64_t points) {
    double least = std::numeric_limits<double>::infinity();
    unsigned best = 0;
    for (resolution_ = 2; resolution_ <= 256 && nodes() <= 150000; resolution_ *= 2) {
      const double cost = static_cast<double>(points + nodes()) / resolution_;
      if (nodes() > points / 2 || cost >= least) continue;
      least = cost;
      best = resolution_;
    }
    resolution_ = best;
  }

  /// Finds a box around the centre whose corners are all in P.
  bool find_box() {
    for (unsigned j = 0; j < k_; ++j) {
      const unsigned c = s_.axis(j);
      magnitude_ = std::max(
          {magnitude_, std::fabs(s_.low[c]) * scale_[j], std::fabs(s_.high[c]) * scale_[j]});
    }
    const double* scratch[7];
    for (double r = 0.5; r >= 0x1p-12; r /= 2) {
      bool all = true;
      std::uint32_t f = 0;
      for (unsigned corner = 0; corner < (1U << k_) && all; ++corner) {
        double direction[6];
        for (unsigned j = 0; j < k_; ++j) direction[j] = (corner >> j & 1U) ? 1 : -1;
        all = inside(direction, r, f, scratch);
      }
      if (!all) continue;
      const double roundoff = 0x1p-53;
      // The corners have an error of at most 2 u (magnitude + r); the box keeps half its size if
      // that is below r / 2. Then `slack` is the eta of the proof.
      const double rounding = 2 * roundoff * (magnitude_ + 2);
      if (!(rounding < r / 2)) return false;
      tiny_ = r / 4;
      slack_ = 2 * (rounding + 16 * roundoff) / (r / 2);
      return slack_ < 0.125;
    }
    return false;
  }

  /// Sets a radius just inside P from the cones' planes; false if they give none.
  bool quick_radius(const double* direction, std::uint32_t& f, double& radius) const {
    double y[6];
    for (unsigned j = 0; j < k_; ++j) y[j] = 0x1p-10 * direction[j];  // within the planes' reach
    cones_.strictly_inside(y, f);
    const double gauge = cones_.value(f, y) * 0x1p10;
    if (!(gauge > 0.5)) return false;
    radius = (1 - 0x1p-20) / gauge;
    for (unsigned j = 0; j < k_; ++j) y[j] = radius * direction[j];
    return cones_.in_box(y) && cones_.strictly_inside(y, f);
  }

  void probe_nodes() {
    const unsigned per_face_dims = k_ - 1;
    std::uint64_t face_nodes = 1, face_cells = 1;
    for (unsigned j = 0; j < per_face_dims; ++j) {
      face_nodes *= resolution_ + 1;
      face_cells *= resolution_;
    }
    std::vector<double> radius(2 * k_ * face_nodes);
    std::vector<std::uint32_t> simplex(radius.size());
    check_chunks(s_.run, radius.size(), 512, [&](std::uint64_t begin, std::uint64_t end) {
      const double* scratch[7];
      std::uint32_t f = 0;
      for (std::uint64_t n = begin; n < end; ++n) {
        double direction[6];
        node_direction(n / face_nodes, n % face_nodes, direction);
        if (quick_radius(direction, f, radius[n])) {
          simplex[n] = f;
          continue;
        }
        double low = 0, high = 2;
        for (unsigned step = 0; step < 10; ++step) {
          const double t = 0.5 * (low + high);
          (inside(direction, t, f, scratch) ? low : high) = t;
        }
        radius[n] = low;
        simplex[n] = f;
      }
    });
    hints_.resize(2 * k_ * face_cells);
    std::vector<float> limits(hints_.size());
    check_chunks(s_.run, limits.size(), 4096, [&](std::uint64_t begin, std::uint64_t end) {
      for (std::uint64_t c = begin; c < end; ++c) {
        double least = 2;
        for (unsigned corner = 0; corner < (1U << per_face_dims); ++corner) {
          std::uint64_t rest = c % face_cells, stride = 1, node = 0;
          for (unsigned j = 0; j < per_face_dims; ++j) {  // last coordinate varies fastest
            node += (rest % resolution_ + (corner >> j & 1U)) * stride;
            rest /= resolution_;
            stride *= resolution_ + 1;
          }
          node += c / face_cells * face_nodes;
          least = std::min(least, radius[node]);
          hints_[c] = simplex[node];
        }
        limits[c] = static_cast<float>(least * (1 - slack_) * (1 - 0x1p-22));  // rounded down
      }
    });
    limits_ = std::move(limits);
  }

  void node_direction(std::uint64_t face, std::uint64_t node, double* direction) const {
    const auto axis = static_cast<unsigned>(face / 2);
    direction[axis] = face % 2 ? -1 : 1;
    for (unsigned i = k_ - 1; i > 0; --i) {  // the other axes in cyclic order, the last one fastest
      const unsigned j = (axis + i) % k_;
      direction[j] = 2.0 * static_cast<double>(node % (resolution_ + 1)) / resolution_ - 1;
      node /= resolution_ + 1;
    }
  }

  const Subject& s_;
  const Cones& cones_;
  const unsigned k_;
  unsigned resolution_ = 0;
  double magnitude_ = 0, slack_ = 0, tiny_ = 0;
  std::vector<double> scale_;
  std::vector<float> limits_;
  std::vector<std::uint32_t> hints_;
};

/// Vertices that points were found to be equal to. Duplicates of a vertex are in the hull; without
/// this cache each would need a walk and a degenerate orientation test.
class VertexCache {
 public:
  explicit VertexCache(const Subject& s) : k_(s.k) { entries_.fill(0xFFFFFFFFU); }
  std::uint32_t& entry(const double* x) {
    std::uint64_t hash = 0;
    for (unsigned j = 0; j < k_; ++j)  // adding zero makes equal numbers bitwise equal
      hash = (std::rotl(hash, 5) ^ std::bit_cast<std::uint64_t>(x[j] + 0.0)) * 0x9E3779B97F4A7C15U;
    return entries_[hash >> 56];
  }

 private:
  unsigned k_;
  std::array<std::uint32_t, 256> entries_;
};

[[noreturn]] void outside(std::uint64_t i) { fault("point ", i, " lies outside the hull"); }

}  // namespace

class PointCheck::Scan {
  static constexpr std::uint32_t none = 0xFFFFFFFFU;

 public:
  Scan(const Subject& s, const Cones& cones)
      : s_(s),
        flat_(flat_of(s)),
        cones_(cones),
        ball_(make_ball(s, cones)),
        filter_(s, cones, count_outside_ball()) {
    if (s.k == 1) low_ = s.row(0)[0] < s.row(1)[0] ? 0 : 1;
  }

  /// Checks points [begin, end) of a block, whose first point has the id `first`.
  void range(const PointView& block, std::uint64_t first, std::uint64_t begin,
             std::uint64_t end) const {
    with_dimension<2, 6, 0>(s_.k, [&](auto k) { range_in<k>(block, first, begin, end); });
  }

 private:
  static InnerBall make_ball(const Subject& s, const Cones& cones) {
    if (!cones.usable() || s.k != s.hull.dimension || !(cones.ball() > 0)) return {};
    return InnerBall(cones.centre(), cones.scales(), cones.ball());
  }

  /// Estimates from a sample how many points, except vertices, the ball leaves to the filter.
  std::uint64_t count_outside_ball() const {
    constexpr std::uint32_t sample = 256;
    const std::uint64_t n = s_.points.count, blocks = 32;
    std::uint64_t left = n;
    if (s_.points.data == nullptr) {
      left = n / 2;  // unknown before points arrive; affects only the grid's resolution, untested
    } else if (ball_.usable() && n > 4 * blocks * sample) {
      std::uint16_t out[InnerBall::block];
      std::uint64_t seen = 0;
      for (std::uint64_t b = 0; b < blocks; ++b)
        seen += ball_.outside(s_.points, n / blocks * b, sample, out);
      left = static_cast<std::uint64_t>(static_cast<double>(n) * static_cast<double>(seen + 1) /
                                        (blocks * sample));
    }
    return left > s_.ids.size() ? left - s_.ids.size() : 0;
  }

  /// K: k if the inner filter is usable, else 0.
  template <unsigned K>
  void range_in(const PointView& points, std::uint64_t first, std::uint64_t begin,
                std::uint64_t end) const {
    const unsigned d = s_.hull.dimension;
    std::vector<double> rows(InnerBall::block * std::size_t{d}), on_axes(s_.k);
    std::uint16_t left[InnerBall::block];
    std::vector<const double*> scratch(s_.k + 1);
    auto vertex = std::lower_bound(s_.ids.begin(), s_.ids.end(), first + begin);
    std::uint32_t f = 0;
    std::uint64_t met = 0;
    VertexCache cache(s_);
    for (std::uint64_t b = begin; b < end; b += InnerBall::block) {
      const auto count =
          static_cast<std::uint32_t>(std::min<std::uint64_t>(InnerBall::block, end - b));
      std::uint32_t kept = count;
      if (ball_.usable()) kept = ball_.outside(points, b, count, left);
      const bool all = kept == count;
      if (all) load_rows_as_given(points, b, b + count, rows.data());
      for (std::uint32_t r = 0; r < kept; ++r) {
        const std::uint64_t at = b + (all ? r : left[r]), i = first + at;
        double* x = rows.data() + std::size_t{r} * d;
        if (!all) load_rows_as_given(points, at, at + 1, x);
        while (vertex != s_.ids.end() && *vertex < i) ++vertex;
        const bool is_vertex = vertex != s_.ids.end() && *vertex == i;
        const auto v = static_cast<std::uint32_t>(vertex - s_.ids.begin());
        if (is_vertex) compare_vertex(v, x);
        met += is_vertex;
        check_flat<K>(i, x, is_vertex ? v : none);
        if (!is_vertex) check_point<K>(i, x, on_axes.data(), f, scratch.data(), cache);
      }
    }
    s_.vertices_met.fetch_add(met, std::memory_order_relaxed);
  }

  /// Compares the coordinates of a point that is the hull's vertex v with the claimed ones.
  void compare_vertex(std::size_t v, const double* x) const {
    const unsigned d = s_.hull.dimension;
    if (s_.claimed != nullptr && !std::equal(x, x + d, s_.full.data() + v * d))
      fault("vertex ", s_.ids[v], " has other coordinates than that point");
  }

  /// `vertex`: of the hull, or none.
  template <unsigned K>
  void check_flat(std::uint64_t i, const double* x, std::uint32_t vertex) const {
    const unsigned k = K ? K : s_.k;
    check_finite(i, x);
    if (k == s_.hull.dimension) return;
    const bool spans = std::find(s_.basis.begin(), s_.basis.end(), vertex) != s_.basis.end();
    std::uint64_t exact = 0;
    const bool inside = spans || flat_.contains(x, &exact);
    if (exact > 0) s_.exact_decisions.fetch_add(exact, std::memory_order_relaxed);
    if (!inside)
      fault("point ", i, " is not in the flat of the vertices: affine dimension ", k,
            " is too low");
  }

  template <unsigned K>
  void check_point(std::uint64_t i, const double* x, double* on_axes, std::uint32_t& f,
                   const double** scratch, VertexCache& cache) const {
    const unsigned d = s_.hull.dimension, k = K ? K : s_.k;
    if (k < d) {
      for (unsigned j = 0; j < k; ++j) on_axes[j] = x[s_.axes[j]];
      x = on_axes;
    }
    if (k == 1)
      check_on_segment(i, x[0]);
    else if (!surely_inside<K>(x, f))
      check_by_ray(i, x, f, scratch, cache);
  }

  void check_finite(std::uint64_t i, const double* x) const {
    for (unsigned j = 0; j < s_.hull.dimension; ++j)
      if (!std::isfinite(x[j])) fault("point ", i, " is not finite");
  }

  template <unsigned K>
  bool surely_inside(const double* x, std::uint32_t& f) const {
    double y[Cones::max_dimension];
    if (!cones_.usable() || !cones_.relative(x, y)) return false;
    if constexpr (K != 0)
      if (filter_.usable() && filter_.template strictly_inside<K>(y, f)) return true;
    return cones_.strictly_inside(y, f);
  }

  void check_on_segment(std::uint64_t i, double x) const {
    const double low = s_.row(low_)[0], high = s_.row(1 - low_)[0];
    if (x < low || x > high) outside(i);
    for (std::uint32_t v = 0; v < 2; ++v)
      if (x == s_.row(v)[0] && i < s_.ids[v]) equals(i, v);
  }

  void check_by_ray(std::uint64_t i, const double* x, std::uint32_t& f, const double** scratch,
                    VertexCache& cache) const {
    std::uint32_t& known = cache.entry(x);
    if (known < s_.ids.size() && std::equal(x, x + s_.k, s_.row(known))) {
      if (i < s_.ids[known]) equals(i, known);
      return;
    }
    f = s_.locate(x, f, scratch);
    const Sign side = s_.side(f, x, scratch);
    if (side == Sign::positive) outside(i);
    if (side == Sign::negative) return;
    for (unsigned j = 0; j < s_.k; ++j) {
      const std::uint32_t v = s_.simplex(f)[j];
      if (!std::equal(x, x + s_.k, s_.row(v))) continue;
      if (i < s_.ids[v]) equals(i, v);
      known = v;
    }
  }

  [[noreturn]] void equals(std::uint64_t i, std::uint32_t v) const {
    fault("point ", i, " equals vertex ", s_.ids[v], " and has the lower id");
  }

  const Subject& s_;
  const FlatTest flat_;
  const Cones& cones_;
  const InnerBall ball_;
  const InnerFilter filter_;
  unsigned low_ = 0;
};

PointCheck::PointCheck(const Subject& s, const Cones& cones)
    : scan_(std::make_unique<const Scan>(s, cones)), s_(s) {}
PointCheck::~PointCheck() = default;

void PointCheck::check(const PointView& block, std::uint64_t first_id) const {
  check_chunks(s_.run, block.count, chunk, [&](std::uint64_t begin, std::uint64_t end) {
    scan_->range(block, first_id, begin, end);
  });
}

}  // namespace cullhull::internal::certify
