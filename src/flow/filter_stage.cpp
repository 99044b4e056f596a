#include <algorithm>
#include <memory>

#include "few/small_3d.hpp"
#include "few/small_hull.hpp"
#include "filter/gauge/gauge_map.hpp"
#include "filter/outermost.hpp"
#include "filter/planner.hpp"
#include "filter/pseudo_hull/pseudo_hull.hpp"
#include "flow/pipeline.hpp"
#include "flow/sample_map.hpp"
#include "geometry/gather.hpp"
#include "parallel/memory/memory.hpp"
#include "parallel/threads/thread_memory.hpp"

namespace cullhull::internal::inline flow {
namespace {

Array<double> pick_rows(const Array<double>& rows, unsigned d,
                        const std::vector<std::uint64_t>& kept) {
  Array<double> out(kept.size() * d);
  for (std::size_t i = 0; i < kept.size(); ++i)
    std::copy_n(rows.data() + kept[i] * d, d, out.data() + i * d);
  return out;
}

PointView view_of_rows(const Filtered& result, unsigned d) {
  return PointView::row_major(result.rows.data(), result.survivors.ids.size(), d);
}

/// The paper's two levels: the subsets' pseudo-hulls, then one of all their survivors.
Filtered run_pseudo_hull(const PointView& points, const Run& run) {
  const unsigned d = points.dimension;
  Filtered result;
  run.report("cull", 0);
  const PseudoHullSettings by_subsets;
  result.survivors.ids = pseudo_hull_survivors(points, by_subsets, run);
  result.survivors.method = "pseudo-hull";
  result.survivors.reason = "filter as asked; the pseudo-hull runs on the CPU";
  if (result.survivors.ids.size() == points.count) {
    result.survivors.ids = {};
    result.survivors.all = true;
    return result;
  }
  gather_survivors(points, result, run);
  const std::uint64_t left = result.pass_survivors;
  // One pseudo-hull of all of them, if it fits. A point takes 45 bytes and its coordinates. On a
  // sphere, where all points are extreme, the largest round has a fifth as many facets as points;
  // half are allowed for, each with d cells in each of two arrays.
  const std::uint64_t bytes = left * (8 * d + 45 + d * (12 * d + 8));
  PseudoHullSettings second;
  second.subsets = bytes <= std::min(run.budget / 2, std::uint64_t{1} << 30) ? 1 : 0;
  keep_of_survivors(result, d, pseudo_hull_survivors(view_of_rows(result, d), second, run));
  return result;
}

/// Fetches samples of points in the host's memory.
SampledPoints host_points(const PointView& points, const Run& run) {
  return {points.count, points.dimension, [&points, &run](const std::vector<std::uint64_t>& ids) {
            return gather_points(points, ids.data(), ids.size(), run);
          }};
}

/// The hull of at most as many points as small_hull_3d takes; of dimension 0 where it fails.
InnerPolytope polytope_of(const PointView& points, const std::vector<std::uint64_t>& ids) {
  struct Memory {
    MediumPoints3D points;
    MediumHull3D hull;
  };
  InnerPolytope polytope;
  if (ids.size() < 4 || ids.size() > MediumHull3D::max_points) return polytope;
  Memory& m = thread_memory<Memory>();
  const auto count = static_cast<unsigned>(ids.size());
  load_small(points, ids.data(), count, m.points);
  if (!small_hull_3d(m.points, count, m.hull)) return polytope;
  MediumHull3D::Number place[MediumHull3D::max_points];
  for (unsigned v = 0; v < m.hull.vertex_count; ++v) {
    const unsigned id = m.hull.ids[v];
    place[id] = static_cast<MediumHull3D::Number>(v);
    for (const auto& axis : m.points.axes) polytope.vertices.push_back(axis[id]);
  }
  polytope.dimension = 3;
  const std::size_t corners = std::size_t{3} * m.hull.count;
  polytope.facets.resize(corners);
  for (std::size_t i = 0; i < corners; ++i) polytope.facets[i] = place[m.hull.vertices[i]];
  polytope.neighbours.assign(m.hull.opposite, m.hull.opposite + corners);
  return polytope;
}

/// The resolution of a map of the outermost points: cones and cells along an edge of the cube of
/// directions.
struct Fineness {
  unsigned cones, cells;
};

/// Positions of the points that are not inside the hull of the outermost; false where no map would
/// pay.
bool kept_by_outermost(const PointView& points, Fineness fine, double most_outside, const Run& run,
                       std::vector<std::uint64_t>& kept) {
  const OutermostSettings settings{.cells = fine.cones, .most_outside = most_outside};
  const std::vector<std::uint64_t> outermost = outermost_points(points, settings);
  if (outermost.empty()) return false;
  const InnerPolytope polytope = polytope_of(points, outermost);
  if (polytope.dimension == 0) return false;
  run.check();
  const auto map = GaugeMap::of_few_facets(polytope, fine.cells);
  if (map == nullptr) return false;
  kept = map->survivors(points, run.with_threads(1));
  return true;
}

/// The filter of some thousand points in space; false where it would not pay. More directions leave
/// fewer points to the engine, but their map takes longer. Measured on balls: of 10,000 points 96
/// directions take 330 us a call, 216 take 213, 384 take 255; of 2,000 points 75, 107 and 127.
bool cull_by_outermost(const PointView& points, const Run& run, Filtered& result) {
  const Fineness first = points.count <= 8192    ? Fineness{4, 8}
                         : points.count <= 32768 ? Fineness{6, 12}
                                                 : Fineness{8, 16};
  // Where more of the points are outside, dropping the rest saves less than the map costs (a
  // guess).
  constexpr double most_outside = 0.75;
  Survivors& survivors = result.survivors;
  if (!kept_by_outermost(points, first, most_outside, run, survivors.ids)) return false;
  survivors.all = false;
  survivors.method = "gauge";
  survivors.reason = "a map of the outermost points in " +
                     std::to_string(6 * first.cones * first.cones) + " directions";
  gather_survivors(points, result, run);
  std::vector<std::uint64_t> kept;
  if (survivors.ids.size() > MediumHull3D::max_points &&
      kept_by_outermost(view_of_rows(result, 3), {12, 16}, 1, run, kept)) {
    keep_of_survivors(result, 3, kept);
    survivors.method = "gauge x2";
  }
  return true;
}

/// The pass of a map over all points, and the stages after it.
void cull_by(CullPass& pass, std::unique_ptr<GaugeMap> map, const PointView& points, const Run& run,
             Filtered& result) {
  const unsigned d = points.dimension;
  result.survivors.method = "gauge";
  SurvivorRows gathered;
  // A second copy of the survivors for a short time; where most points survive, fetching them later
  // costs no more.
  gathered.most = std::min(run.budget / (16 * d * sizeof(double)), points.count / 4);
  pass.cull(*map, result.survivors, &gathered);
  map.reset();
  if (d == 2 && result.survivors.ids.size() > points.count / 10 * 9) {
    // Points so close together that single precision does not separate them. The plane's engine
    // drops inner points in double precision, from the caller's memory.
    result.survivors.ids = {};
    result.survivors.all = true;
    result.survivors.reason += "; it kept nearly all";
    return;
  }
  result.rows = std::move(gathered.rows);

  gather_survivors(points, result, run);
  refine_survivors(result, d, run);
}

}  // namespace

void keep_of_survivors(Filtered& result, unsigned d, const std::vector<std::uint64_t>& kept,
                       Array<double>&& rows) {
  std::vector<std::uint64_t> ids(kept.size());
  for (std::size_t i = 0; i < kept.size(); ++i) ids[i] = result.survivors.ids[kept[i]];
  result.rows = rows.empty() ? pick_rows(result.rows, d, kept) : std::move(rows);
  result.survivors.ids = std::move(ids);
}

void gather_survivors(const PointView& points, Filtered& result, const Run& run) {
  const std::uint64_t left = result.survivors.ids.size();
  result.pass_survivors = left;
  require_budget(run.budget, left * (points.dimension + 2) * sizeof(double),
                 std::to_string(left) + " points that survive the filter");
  if (result.rows.empty())
    result.rows = gather_points(points, result.survivors.ids.data(), left, run);
  else
    check_rows_finite(result.rows.data(), left, points.dimension, result.survivors.ids.data(), run);
  run.report("cull", 0.8);
}

std::string why_no_filter(CullMethod method, std::uint64_t count, unsigned d) {
  if (method == CullMethod::none) return "no filter, as asked";
  if (method == CullMethod::pseudo_hull) return "the pseudo-hull is for 2D to 8D";
  if (d < GaugeMap::min_dimension || d > GaugeMap::max_dimension)
    return "the gauge map is for 2D to 6D";
  if (count <= d + 1 || (method == CullMethod::automatic && count < smallest_worth_culling(d)))
    return std::to_string(count) + " points are hulled sooner than a map is laid";
  return "";
}

Filtered run_filter(const PointView& points, const Run& run) {
  Filtered result;
  result.survivors.all = true;
  result.pass_survivors = points.count;
  const unsigned d = points.dimension;
  if (run.options.cull == CullMethod::pseudo_hull && d >= pseudo_hull_min_dimension &&
      d <= pseudo_hull_max_dimension && points.count > d + 1)
    return run_pseudo_hull(points, run);
  const bool forced = run.options.cull == CullMethod::gauge;
  if (run.options.cull == CullMethod::automatic && run.options.backend != Backend::cuda && d == 3 &&
      points.count > most_unfiltered_in_space && points.count <= most_by_outermost &&
      cull_by_outermost(points, run, result))
    return result;
  result.survivors.reason = why_no_filter(run.options.cull, points.count, d);
  if (!result.survivors.reason.empty()) return result;

  run.report("cull", 0);
  CullPass pass(points, run);
  SampledMap sampled;
  try {
    sampled = map_of_sample(host_points(points, run), forced ? Insist::yes : Insist::no,
                            pass.most_nodes(), run);
  } catch (const Error& e) {
    if (e.code() != ErrorCode::not_finite) throw;
    check_finite(points, nullptr, run);  // names the first bad point, not the sample's
  }
  result.survivors.reason = sampled.reason;
  if (sampled.map == nullptr) return result;
  cull_by(pass, std::move(sampled.map), points, run, result);
  return result;
}

Filtered filter_by(InnerPolytope polytope, const PointView& points, const Run& run) {
  Filtered result;
  result.survivors.all = true;
  result.pass_survivors = points.count;
  if (polytope.dimension != points.dimension) return result;
  CullPass pass(points, run);
  auto map = map_of_polytope(std::move(polytope), points.count, Insist::no, pass.most_nodes(), run);
  if (map != nullptr) cull_by(pass, std::move(map), points, run, result);
  return result;
}

// Survivors lie near the boundary, so a sample of them gives a much finer polytope.
void refine_survivors(Filtered& result, unsigned d, const Run& run) {
  const PointView left = view_of_rows(result, d);
  if (left.count < smallest_worth_refining(d)) return;
  const SampledMap sampled = map_of_sample(host_points(left, run), Insist::late, 0, run);
  result.survivors.reason += "; a second map: " + sampled.reason;
  if (sampled.map == nullptr) return;
  SurvivorRows gathered;
  const std::vector<std::uint64_t> kept = sampled.map->survivors(left, run, &gathered);
  keep_of_survivors(result, d, kept, std::move(gathered.rows));
  result.survivors.method = "gauge x2";
}

}  // namespace cullhull::internal::inline flow
