#include "cullhull/alpha_shape.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "cullhull/error.hpp"
#include "delaunay/write_triangulation.hpp"
#include "diagrams/dual.hpp"
#include "diagrams/memory_needs.hpp"
#include "exact/insphere/circumcentre.hpp"
#include "exact/insphere/circumcentres.hpp"
#include "parallel/disjoint_sets.hpp"

namespace cullhull::internal {
namespace {

void require_delaunay(const Triangulation& t) {
  if (t.furthest_site)
    throw Error(ErrorCode::invalid_argument,
                "alpha shapes are of Delaunay triangulations, not of the furthest site");
}

/// Calls body(cell, rows of its corners, radius) for all cells; radius: that of radius_above(), or
/// NaN where vectors of cells do not tell.
template <class Body>
void each_cell(const DualPoints& p, const Triangulation& t, const Run& run, const Body& body) {
  const unsigned k = t.corners() - 1;
  const bool by_blocks = k == t.dimension && has_centres_block(k);
  run.each(t.size(), light_grain / 64, [&](std::uint64_t begin, std::uint64_t end) {
    std::vector<const double*> rows(k + 1);
    std::vector<double> corners(by_blocks ? std::size_t{k + 1} * k * centres_block : 0);
    double radii[centres_block];
    std::fill_n(radii, centres_block, NAN);
    for (std::uint64_t first = begin; first < end; first += centres_block) {
      const std::uint64_t count = std::min<std::uint64_t>(centres_block, end - first);
      if (by_blocks) {
        load_block(
            p, k, first, count, [&](std::uint64_t c) { return t.cell(c); }, corners.data());
        circumradii_double_double(k, corners.data(), radii);
      }
      for (std::uint64_t lane = 0; lane < count; ++lane) {
        for (unsigned i = 0; i <= k; ++i) rows[i] = p.row(t.cell(first + lane)[i]);
        body(first + lane, rows.data(), radii[lane]);
      }
    }
  });
}

/// The least radius at which every vertex has a cell: the maximum over the vertices of the smallest
/// radius of a cell at the vertex.
double greatest_first_radius(const Triangulation& t, const Array<double>& radii) {
  Array<double> first(t.point_count);
  std::fill(first.begin(), first.end(), INFINITY);
  for (std::uint64_t c = 0; c < t.size(); ++c)
    for (const std::uint32_t v : t.cell(c)) first[v] = std::min(first[v], radii[c]);
  double greatest = 0;
  for (const std::uint32_t v : t.cells) greatest = std::max(greatest, first[v]);
  return greatest;
}

/// The least radius, at least `least`, at which the cells of at most that radius are connected:
/// joins cells in ascending order of their radii.
double first_single_region(const Triangulation& t, const Array<double>& radii, double least) {
  const auto count = static_cast<std::uint32_t>(t.size());
  std::vector<std::uint32_t> order(count);
  std::iota(order.begin(), order.end(), 0U);
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    return radii[a] != radii[b] ? radii[a] < radii[b] : a < b;
  });
  DisjointSets regions(count);
  regions.clear(0, count);
  std::vector<bool> there(count);
  std::uint32_t region_count = 0;
  for (std::uint32_t i = 0; i < count; ++i) {
    const std::uint32_t c = order[i];
    there[c] = true;
    ++region_count;
    for (const std::uint32_t o : t.neighbours_of(c)) {
      if (o == no_index || !there[o] || regions.root(o) == regions.root(c)) continue;
      regions.join(o, c);
      --region_count;
    }
    const bool more = i + 1 < count && radii[order[i + 1]] == radii[c];
    if (!more && region_count == 1 && radii[c] >= least) return radii[c];
  }
  return least;
}

}  // namespace
}  // namespace cullhull::internal

namespace cullhull {

AlphaShape alpha_shape(const PointView& points, const Triangulation& triangulation, double alpha,
                       const RunOptions& options) {
  using namespace internal;
  const Triangulation& t = triangulation;
  if (!(alpha >= 0))
    throw Error(ErrorCode::invalid_argument, "alpha must be a number that is not negative");
  require_delaunay(t);
  const Call call(options);
  const Run& run = call.run;
  begin_step(run, shape_bytes(t.point_count, t.size(), t.dimension), "the cells of the shape");
  const DualPoints p(points, t, {}, run);
  AlphaShape out;
  if (t.corners() == 0) return out;
  const unsigned k = t.corners() - 1;
  Array<std::uint8_t> kept(t.size());
  each_cell(p, t, run, [&](std::uint64_t c, const double* const* rows, double radius) {
    kept[c] = k == 0 || std::isinf(alpha) ||
              (std::isnan(radius) ? radius_at_most(t.dimension, k, rows, alpha) : radius <= alpha);
  });
  for (std::uint32_t c = 0; c < t.size(); ++c)
    if (kept[c] != 0) out.cells.push_back(c);
  write_boundary(t, kept.data(), out.facets, out.facet_cells, run);
  return out;
}

Array<double> alpha_radii(const PointView& points, const Triangulation& triangulation,
                          const RunOptions& options) {
  using namespace internal;
  const Triangulation& t = triangulation;
  require_delaunay(t);
  const Call call(options);
  const Run& run = call.run;
  begin_step(run, shape_bytes(t.point_count, t.size(), t.dimension), "the cells of the shape");
  const DualPoints p(points, t, {}, run);
  Array<double> radii(t.size());
  const unsigned k = t.corners() == 0 ? 0 : t.corners() - 1;
  if (t.corners() == 0) return radii;
  each_cell(p, t, run, [&](std::uint64_t c, const double* const* rows, double radius) {
    radii[c] = k == 0 ? 0 : std::isnan(radius) ? radius_above(t.dimension, k, rows) : radius;
  });
  return radii;
}

double critical_alpha(const PointView& points, const Triangulation& triangulation, bool one_region,
                      const RunOptions& options) {
  using namespace internal;
  const Array<double> radii = alpha_radii(points, triangulation, options);
  const double all = greatest_first_radius(triangulation, radii);
  return one_region ? first_single_region(triangulation, radii, all) : all;
}

}  // namespace cullhull
