#include "filter_stage.hpp"

#include <algorithm>
#include <memory>

#include "cull/gauge_map.hpp"
#include "cull/planner.hpp"
#include "cull/pseudo_hull.hpp"
#include "hull/engine.hpp"
#include "points/gather.hpp"
#include "points/local_frame.hpp"

namespace cullhull::internal {
namespace {

/// `size` ids spread evenly over [0, count), each at a pseudo-random place in its stretch, so that
/// no period of the input's order can hide points from the sample.
std::vector<std::uint64_t> sample_ids(std::uint64_t count, std::uint64_t size) {
  std::vector<std::uint64_t> ids(size);
  std::uint64_t random = 0x9E3779B97F4A7C15ULL;
  const double stretch = static_cast<double>(count) / static_cast<double>(size);
  for (std::uint64_t i = 0; i < size; ++i) {
    random ^= random << 13;
    random ^= random >> 7;
    random ^= random << 17;
    const double at =
        (static_cast<double>(i) + static_cast<double>(random >> 11) * 0x1p-53) * stretch;
    ids[i] = std::min(count - 1, static_cast<std::uint64_t>(at));
  }
  ids.erase(std::unique(ids.begin(), ids.end()), ids.end());
  return ids;
}

struct Sampled {
  InnerPolytope polytope;
  std::uint64_t size = 0;
  std::uint64_t extreme() const {
    return polytope.dimension == 0 ? 0 : polytope.vertices.size() / polytope.dimension;
  }
};

Sampled hull_of_sample(const PointView& points, std::uint64_t size, const Run& run) {
  const std::vector<std::uint64_t> ids = sample_ids(points.count, size);
  Sampled s;
  s.size = ids.size();
  s.polytope = inner_polytope(gather_points(points, ids.data(), ids.size(), run.threads),
                              points.dimension, run);
  return s;
}

/// A map over `points` from a sample of them, or null where it would not pay.
std::unique_ptr<GaugeMap> map_of_sample(const PointView& points, bool forced, const Run& run) {
  const unsigned d = points.dimension;
  const std::uint64_t probe_size = probe_sample_size(points.count, d);
  Sampled sample = hull_of_sample(points, probe_size, run);
  if (sample.polytope.dimension == 0) return nullptr;
  if (!forced && !cull_pays(points.count, d, sample.size, sample.extreme())) return nullptr;
  const std::uint64_t size = map_sample_size(points.count, d, sample.size, sample.extreme());
  if (size > sample.size) sample = hull_of_sample(points, size, run);
  if (sample.polytope.dimension == 0) return nullptr;
  return GaugeMap::build(std::move(sample.polytope), {.threads = run.threads});
}

std::vector<double> pick_rows(const std::vector<double>& rows, unsigned d,
                              const std::vector<std::uint64_t>& kept) {
  std::vector<double> out(kept.size() * d);
  for (std::size_t i = 0; i < kept.size(); ++i)
    std::copy_n(rows.data() + kept[i] * d, d, out.data() + i * d);
  return out;
}

PointView view_of_rows(const Filtered& result, unsigned d) {
  return PointView::row_major(result.rows.data(), result.survivors.ids.size(), d);
}

/// The paper's two levels: the subsets' pseudo-hulls, then one of all that they left.
Filtered run_pseudo_hull(const PointView& points, const Run& run) {
  const unsigned d = points.dimension;
  Filtered result;
  run.control.report("cull", 0);
  const PseudoHullSettings by_subsets;
  result.survivors.ids = pseudo_hull_survivors(points, by_subsets, run.threads, run.control);
  result.survivors.method = "pseudo-hull";
  if (result.survivors.ids.size() == points.count) {
    result.survivors.ids = {};
    result.survivors.all = true;
    return result;
  }
  gather_survivors(points, result, run);
  const std::uint64_t left = result.first_pass;
  // One pseudo-hull of all of them, unless it would be large. A point takes 45 bytes and its
  // coordinates. A sphere, all extreme, has a fifth as many facets as points in its largest round;
  // half are allowed for, each with d cells in each of two arrays.
  const std::uint64_t bytes = left * (8 * d + 45 + d * (12 * d + 8));
  PseudoHullSettings second;
  second.subsets = bytes <= std::min(run.budget / 2, std::uint64_t{1} << 30) ? 1 : 0;
  keep_of_survivors(
      result, d, pseudo_hull_survivors(view_of_rows(result, d), second, run.threads, run.control));
  return result;
}

}  // namespace

InnerPolytope inner_polytope(std::vector<double>&& rows, unsigned d, const Run& run) {
  InnerPolytope polytope;
  const auto count = static_cast<std::uint32_t>(rows.size() / d);
  const std::vector<double> original = rows;
  const LocalFrame frame(std::move(rows), count, d, run.control);
  if (frame.affine_dimension() != static_cast<int>(d)) return polytope;
  SimplicialHull hull;
  try {
    hull = d == 2   ? hull_2d(frame.points(), run.control)
           : d == 3 ? hull_3d(frame.points(), frame.simplex().data(), run.budget, run.control)
                    : hull_nd(frame.points(), frame.simplex().data(), run.budget, run.control);
  } catch (const Error& e) {
    if (e.code() != ErrorCode::out_of_budget) throw;
    return polytope;  // the filter is a help, not a need
  }
  // Renumber the vertices in use.
  constexpr std::uint32_t unused = 0xFFFFFFFF;
  std::vector<std::uint32_t> number(count, unused);
  for (std::uint32_t& v : hull.vertices) {
    if (number[v] == unused) {
      number[v] = static_cast<std::uint32_t>(polytope.vertices.size() / d);
      polytope.vertices.insert(polytope.vertices.end(), original.begin() + std::size_t{v} * d,
                               original.begin() + (std::size_t{v} + 1) * d);
    }
    v = number[v];
  }
  polytope.dimension = d;
  polytope.facets = std::move(hull.vertices);
  polytope.neighbours = std::move(hull.neighbours);
  return polytope;
}

void keep_of_survivors(Filtered& result, unsigned d, const std::vector<std::uint64_t>& kept) {
  std::vector<std::uint64_t> ids(kept.size());
  for (std::size_t i = 0; i < kept.size(); ++i) ids[i] = result.survivors.ids[kept[i]];
  result.rows = pick_rows(result.rows, d, kept);
  result.survivors.ids = std::move(ids);
}

void gather_survivors(const PointView& points, Filtered& result, const Run& run) {
  const std::uint64_t left = result.survivors.ids.size();
  result.first_pass = left;
  require_budget(run.budget, left * (points.dimension + 2) * sizeof(double),
                 std::to_string(left) + " points that survive the filter");
  result.rows = gather_points(points, result.survivors.ids.data(), left, run.threads);
  run.control.report("cull", 0.8);
}

void refine_by_sample(Filtered& result, unsigned d, const Run& run) {
  const PointView left = view_of_rows(result, d);
  if (left.count < smallest_worth_refining(d)) return;
  const std::unique_ptr<GaugeMap> map = map_of_sample(left, true, run);
  if (map == nullptr) return;
  keep_of_survivors(result, d, map->survivors(left, run.threads, run.control));
  result.survivors.method = "gauge x2";
}

Filtered run_filter(const PointView& points, const Run& run) {
  Filtered result;
  result.survivors.all = true;
  result.first_pass = points.count;
  const unsigned d = points.dimension;
  const CullMethod method = run.options.cull;
  if (method == CullMethod::pseudo_hull && d >= pseudo_hull_min_dimension &&
      d <= pseudo_hull_max_dimension && points.count > d + 1)
    return run_pseudo_hull(points, run);
  const bool forced = method == CullMethod::gauge;
  if (method == CullMethod::none || method == CullMethod::pseudo_hull ||
      d < GaugeMap::min_dimension || d > GaugeMap::max_dimension || points.count <= d + 1 ||
      (!forced && points.count < smallest_worth_culling(d)))
    return result;

  run.control.report("cull", 0);
  std::unique_ptr<GaugeMap> map;
  try {
    map = map_of_sample(points, forced, run);
  } catch (const Error& e) {
    if (e.code() != ErrorCode::not_finite) throw;
    check_finite(points, nullptr, run.threads);  // names the first bad point, not the sample's
  }
  if (map == nullptr) return result;
  result.survivors.ids = map->survivors(points, run.threads, run.control);
  result.survivors.all = false;
  result.survivors.method = "gauge";
  map.reset();
  gather_survivors(points, result, run);
  // Survivors lie near the boundary, so a sample of them gives a much finer polytope.
  refine_by_sample(result, d, run);
  return result;
}

}  // namespace cullhull::internal
