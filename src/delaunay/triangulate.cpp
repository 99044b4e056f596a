// delaunay() and regular_triangulation(): prepare, insert, write.
#include "delaunay/triangulate.hpp"

#include <algorithm>
#include <memory>
#include <span>
#include <utility>

#include "cullhull/error.hpp"
#include "cullhull/triangulation.hpp"
#include "delaunay/cell_insertion.hpp"
#include "delaunay/insert_together.hpp"
#include "delaunay/memory_needs.hpp"
#include "delaunay/parts.hpp"
#include "delaunay/plane_insertion.hpp"
#include "delaunay/write_triangulation.hpp"
#include "geometry/gather.hpp"
#include "parallel/dispatch.hpp"
#include "parallel/threads/parallel.hpp"
#include "parallel/threads/run.hpp"

namespace cullhull::internal {
namespace {

// Example: 10^7 points in space make some 6.7 * 10^7 cells; with 36 bytes of vertices, neighbours
// and mark each the store alone is 2.4 GB, to which planes and the result come (bytes_per_cell).

/// Throws out_of_budget if that many cells are expected to exceed run.budget, which is for cells.
void check_cells(double cells, const LiftedPoints& s, const Run& run) {
  const double bytes = cells * static_cast<double>(bytes_per_cell(s.base));
  if (bytes <= static_cast<double>(run.budget)) return;
  const std::uint64_t beside = s.count * bytes_per_point(s.width);
  require_budget(
      run.budget + beside, static_cast<std::uint64_t>(bytes) + beside,
      "about " + std::to_string(static_cast<std::uint64_t>(cells)) + " cells of the triangulation");
}

// In the plane n points have at most 2 n - 5 triangles (Euler). In space random points have about
// 6.7 cells each, points on two skew lines n^2 / 4, so the number is measured: after 1,000 random
// points, then after 4,000, 16,000, ... The estimate lets the call end with an error that names the
// bytes before the memory is full.

/// In the plane the number of cells is known. In more dimensions it is estimated when the first
/// points have been inserted, which are a random sample, and again when there are four times as
/// many. Beyond a line, cells a point grow with the number of points, or stay as many.
class CellEstimate {
 public:
  CellEstimate(const LiftedPoints& s, const Run& run) : s_(s), run_(run) {
    if (s.base <= 2 && !s.may_hide) check_cells(double(s.base) * s.count, s, run);
  }
  /// `inserted`: the number of points so far.
  template <class Store>
  void update(const Store& store, std::size_t inserted) {
    if (inserted < next_) return;
    next_ = 4 * inserted;
    if (s_.base <= 2 || s_.may_hide) return;
    // The sample's cells at the hull are a larger part than those of all points.
    constexpr double margin = 0.9;
    check_cells(margin * store.living() * (double(s_.count) / double(inserted)), s_, run_);
  }

 private:
  const LiftedPoints& s_;
  const Run& run_;
  std::size_t next_ = 1000;
};

// Why one thread begins: in a triangulation of 100 cells nearly every walk of one thread meets
// cells that another holds, and both put their points off. After 1,024 points in space there are
// some 7,000 cells, and two random cavities of some tens of cells seldom touch.

/// The number of points that one thread inserts before others join; in a smaller triangulation the
/// threads would contend for the same cells. A third to three times these numbers gain the same
/// (3D: tested with 1,000 to 30,000 points; 4D and 5D: with as many as take the same time).
template <unsigned K>
std::size_t alone_first(const LiftedPoints& s, const Run& run) {
  constexpr std::size_t all = ~std::size_t{0};
  if (K == 1 || run.threads == 1) return all;
  const std::size_t alone = K == 2 ? 4096 : K == 3 ? 1024 : K == 4 ? 256 : K == 5 ? 128 : 512;
  // In 3D two threads take as long as one for 2,000 to 8,000 points, and a fifth less for 16,000.
  return s.count >= (K == 3 ? 8 : 2) * alone ? alone : all;
}

template <unsigned K>
std::unique_ptr<CellStore<K>> insert_in_turn(const Prepared& p, InsertionTotals& totals,
                                             const Run& run) {
  CellInsertion<K> engine(p.points, run);
  const std::size_t alone = alone_first<K>(p.points, run);
  // With room for the cells that lanes reserve and do not use, the store need not grow.
  const std::uint32_t unused = alone < p.points.count ? p.points.count / 8 : 0;
  engine.start(p.simplex.data(), p.points.count + unused);
  std::vector<std::uint32_t> first(p.simplex);
  std::sort(first.begin(), first.end());
  Array<std::uint32_t> places(p.points.count - first.size());
  run.each(p.points.count, light_grain, [&](std::uint64_t begin, std::uint64_t end) {
    auto before = std::lower_bound(first.begin(), first.end(), begin) - first.begin();
    for (std::uint64_t i = begin; i < end; ++i) {
      const bool skip = std::size_t(before) < first.size() && first[before] == i;
      if (!skip) places[i - before] = static_cast<std::uint32_t>(i);
      before += skip ? 1 : 0;
    }
  });
  std::size_t next = 0;
  CellEstimate estimate(p.points, run);
  for (; next < std::min(alone, places.size()); ++next) {
    engine.insert(places[next]);
    estimate.update(engine.store(), next + 1);
    if (next % 65536 == 65535) run.report("triangulate", double(next) / p.points.count);
  }
  if (next < places.size()) {
    InsertTogether<K> together(p.points, run, engine);
    together.insert(std::span(places).subspan(next), static_cast<std::uint32_t>(next),
                    [&](std::uint32_t done) { estimate.update(engine.store(), done); });
    totals.counts.add(together.counts());
  }
  totals.add(engine.counts(), engine.store().created());
  return std::make_unique<CellStore<K>>(std::move(engine.store()));
}

// Example: a million points on 4 threads are 2 levels, 4 parts of 250,000. 10,000 points stay
// whole, as half of them are fewer than `least`.

/// log2 of the number of parts (triangulate_in_parts); 0: one part. A seam between two parts costs
/// about the square root of the number of points; parts are worthwhile from about 8,000 points
/// each.
unsigned part_levels(const LiftedPoints& s, const Run& run) {
  if (s.may_hide || !s.filtered || s.tiny > 0x1p-1000 || s.stride != s.base) return 0;
  constexpr std::uint32_t least = 1U << 13;
  unsigned levels = 0;
  while (levels < 6 && 1U << levels < run.threads && s.count >> (levels + 1) >= least) ++levels;
  return levels;
}

template <unsigned K>
void insert_and_write(const Prepared& p, Triangulation& out, const Run& run) {
  TriangulationStatistics& statistics = out.statistics;
  auto start = Clock::now();
  run.report("triangulate", 0);
  InsertionTotals totals;
  std::unique_ptr<CellStore<K>> cells;
  if constexpr (K == 2) {
    (void)CellEstimate(p.points, run);  // before the parts
    if (const unsigned levels = part_levels(p.points, run); levels > 0)
      cells = triangulate_in_parts(p, levels, totals, run);
    if (cells == nullptr && plain_plane(p.points)) cells = triangulate_in_parts(p, 0, totals, run);
  }
  if (cells == nullptr) cells = insert_in_turn<K>(p, totals, run);
  for (unsigned r = 0; r < 3; ++r) statistics.rung_counts[r] += totals.counts.rungs[r];
  statistics.ties += totals.counts.ties;
  statistics.cells_created += totals.created;
  statistics.insert_seconds = seconds_since(start);
  start = Clock::now();
  run.report("write", 0);
  if (run.options.memory_budget != 0) trim_pages(run.budget / 8);  // of the planes
  write_cells(p.points, *cells, out, run);
  statistics.write_seconds = seconds_since(start);
}

/// Triangulates all points except `left_out`, prepared as `p`. With weights, sets `redundant` to
/// the vertices that are not extreme points.
Triangulation triangulate_without(const PointView& points, std::span<const double> weights,
                                  bool furthest, const std::vector<std::uint32_t>& left_out,
                                  const Run& run, Prepared& p,
                                  std::vector<std::uint32_t>& redundant) {
  Triangulation out;
  out.dimension = points.dimension;
  out.point_count = points.count;
  out.scalar = points.scalar;
  out.furthest_site = furthest;
  if (points.count == 0) return out;
  auto start = Clock::now();
  TriangulationStatistics& statistics = out.statistics;
  run.report("order", 0);
  p = prepare_points(points, weights, furthest, left_out, run);
  out.axes = p.axes;
  out.duplicates = std::move(p.duplicates);
  out.affine_dimension = static_cast<int>(p.points.base);
  statistics.order_seconds = seconds_since(start);
  if (p.points.base == 0) {  // a single point
    out.cells.assign(1, p.points.ids[0]);
    out.neighbours.assign(1, no_index);
    return out;
  }
  // The points' own memory is taken already; the rest of the budget is for the cells.
  const std::uint64_t held = p.points.count * bytes_per_point(points.dimension);
  const Run for_cells = run.with_budget(run.budget - std::min(held, run.budget - 1));
  constexpr unsigned most = plane_only ? 2 : 6, beyond = plane_only ? 2 : 0;
  with_dimension<1, most, beyond>(p.points.base,
                                  [&](auto k) { insert_and_write<k()>(p, out, for_cells); });
  start = Clock::now();
  if (!plane_only && !weights.empty()) redundant = redundant_vertices(p.points, out, run);
  if (p.points.may_hide) out.hidden = hidden_points(out);
  statistics.write_seconds += seconds_since(start);
  return out;
}

}  // namespace

Triangulation triangulate(const PointView& points, std::span<const double> weights,
                          const TriangulationOptions& o, Prepared& p) {
  require_points(points);
  if (points.count >= no_index)
    throw Error(ErrorCode::out_of_budget,
                "a triangulation takes fewer than 4294967295 points, not ", points.count);
  // In 4D, 100 points have at most 9,312 cells, as many as the cyclic polytope has facets.
  const Call call(o, points.count <= 100 && points.dimension <= 4);
  const Run& run = call.run;
  const auto start = Clock::now();
  run.check();
  if (o.memory_budget != 0) trim_pages(run.budget / 8);
  // What is needed before any cell is made: the coordinates twice and the order of insertion.
  require_budget(run.budget, points.count * (16 * std::uint64_t{points.dimension} + 24),
                 "the coordinates and the order of the points");
  std::vector<std::uint32_t> redundant, left_out;
  Triangulation out =
      triangulate_without(points, weights, o.furthest_site, left_out, run, p, redundant);
  // The perturbation makes vertices of points exactly on a face. These are not extreme points, so
  // the remaining points are triangulated again, without them and without the hidden points. All
  // points are then extreme.
  if (!redundant.empty()) {
    left_out.resize(redundant.size() + out.hidden.size());
    std::merge(redundant.begin(), redundant.end(), out.hidden.begin(), out.hidden.end(),
               left_out.begin());
    p = {};  // the memory of both is not needed meanwhile
    out = {};
    out = triangulate_without(points, weights, o.furthest_site, left_out, run, p, redundant);
  }
  out.statistics.threads = run.threads;
  out.statistics.compute_seconds = seconds_since(start);
  run.report("done", 1);
  return out;
}

}  // namespace cullhull::internal

namespace cullhull {

Triangulation delaunay(const PointView& points, const TriangulationOptions& options) {
  if (Triangulation few; internal::triangulate_few_in_plane(points, options, few)) return few;
  internal::Prepared prepared;
  return internal::triangulate(points, {}, options, prepared);
}

Triangulation regular_triangulation(const PointView& points, std::span<const double> weights,
                                    const TriangulationOptions& options) {
  internal::require_weights(weights, points.count);
  internal::Prepared prepared;
  Triangulation result = internal::triangulate(points, weights, options, prepared);
  result.weighted = true;
  return result;
}

}  // namespace cullhull
