// THE FLOW: validate, cull, hull, result.
#include "flow/pipeline.hpp"

#include <algorithm>
#include <string>

#include "cuda/backend.hpp"
#include "cull/lattice_cull.hpp"
#include "cull/planner.hpp"
#include "cullhull/certify.hpp"
#include "cullhull/cull.hpp"
#include "cullhull/error.hpp"
#include "cullhull/extreme_points.hpp"
#include "cullhull/hull.hpp"
#include "extreme/extreme_ids.hpp"
#include "flow/filter_stage.hpp"
#include "geometry/gather.hpp"
#include "geometry/local_frame.hpp"
#include "hull/engine.hpp"
#include "hull/plane/polygon.hpp"
#include "hull/space/surface_3d.hpp"
#include "parallel/control.hpp"
#include "parallel/helpers.hpp"
#include "parallel/pages.hpp"
#include "result/build_hull.hpp"
#include "result/extreme_rows.hpp"
#include "result/polygon_result.hpp"
#include "small/few_in_space.hpp"
#include "small/small_hull.hpp"

namespace cullhull {
namespace internal {
namespace {

/// The points the engine works on: survivors, thinned once more where they lie on a lattice.
struct EngineInput {
  std::vector<std::uint64_t> ids;  // empty and `all`: every point of the view
  bool all = false;
  Array<double> rows;
  std::uint64_t count = 0;
};

void thin_lattice(EngineInput& input, unsigned d, unsigned threads, const Control& control) {
  // Below this many points the engine is done before the sorts are.
  constexpr std::uint64_t worthwhile = 256;
  std::vector<std::uint32_t> kept;
  if (input.count < worthwhile ||
      !lattice_cull(input.rows, static_cast<std::uint32_t>(input.count), d, threads, control,
                    kept) ||
      kept.size() == input.count)
    return;
  Array<double> rows(kept.size() * d);
  std::vector<std::uint64_t> ids(kept.size());
  for (std::size_t i = 0; i < kept.size(); ++i) {
    std::copy_n(input.rows.data() + std::size_t{kept[i]} * d, d, rows.data() + i * d);
    ids[i] = input.all ? kept[i] : input.ids[kept[i]];
  }
  input.rows = std::move(rows);
  input.ids = std::move(ids);
  input.all = false;
  input.count = kept.size();
}

void require_engine_room(std::uint64_t count, unsigned dimension, std::uint64_t budget) {
  if (count >= 0xFFFFFFFF)
    throw Error(ErrorCode::out_of_budget,
                std::to_string(count) + " points survive the filter; an engine takes 2^32 - 2");
  // Coordinates, a copy in the engine's order, keys and ids to sort them by.
  require_budget(budget, count * (2 * dimension * sizeof(double) + 24),
                 std::to_string(count) + " points that survive the filter");
}

EngineInput engine_input(const PointView& points, Filtered&& filtered, std::uint64_t budget,
                         unsigned threads, const Control& control) {
  EngineInput input;
  input.all = filtered.survivors.all;
  input.count = filtered.survivors.size(points.count);
  require_engine_room(input.count, points.dimension, budget);
  input.rows = std::move(filtered.rows);
  if (input.rows.empty())
    input.rows = gather_points(points, input.all ? nullptr : filtered.survivors.ids.data(),
                               input.count, threads, control);
  input.ids = std::move(filtered.survivors.ids);
  thin_lattice(input, points.dimension, threads, control);
  return input;
}

SimplicialHull ends_of_line(const LocalPoints& points) {
  std::uint32_t low = 0, high = 0;
  for (std::uint32_t i = 1; i < points.count; ++i) {
    if (points.exact_row(i)[0] < points.exact_row(low)[0]) low = i;
    if (points.exact_row(i)[0] > points.exact_row(high)[0]) high = i;
  }
  SimplicialHull ends;
  ends.dimension = 1;
  ends.vertices = {low, high};
  ends.neighbours = {1, 0};
  return ends;
}

SimplicialHull run_engine(const LocalFrame& frame, Engine engine, std::uint64_t budget,
                          unsigned threads, const Control& control) {
  const LocalPoints& points = frame.points();
  if (points.dimension == 1) return ends_of_line(points);
  if (engine == Engine::qhull) return hull_qhull(points, control);
  if (points.dimension == 2) return hull_2d(points, threads, control);
  return hull_nd(points, frame.simplex().data(), budget, threads, control);
}

/// What a filter left of points of the plane: they need no frame and are hulled where they lie.
struct PlanarRows {
  PlanarRows(const PointView& points, const Filtered& filtered)
      : rows(filtered.survivors.all
                 ? points
                 : PointView::row_major(filtered.rows.data(), filtered.survivors.ids.size(), 2)),
        ids(filtered.survivors.all ? nullptr : filtered.survivors.ids.data()) {}

  Polygon hull(const Run& run) const {
    require_engine_room(rows.count, 2, run.budget);
    return polygon_of(rows, false, run.threads, run.control);
  }

  PointView rows;
  const std::uint64_t* ids;
};

void extreme_in_plane(const PointView& points, const Filtered& filtered, const Run& run,
                      ExtremePoints& result) {
  const PlanarRows rows(points, filtered);
  const Polygon polygon = rows.hull(run);
  result.affine_dimension = static_cast<int>(std::min<std::size_t>(polygon.corners.size(), 3)) - 1;
  result.ids = ascending_ids(polygon.corners.data(), polygon.corners.size(), polygon.rows, rows.ids,
                             run.threads, run.control);
  std::copy(polygon.rung_counts, polygon.rung_counts + 3, result.statistics.rung_counts);
}

/// False for flats and for polygons of extraordinary proportions: then the corners alone are left
/// of `filtered`, whose hull is the same.
bool hull_in_plane(const PointView& points, Filtered& filtered, const Run& run, Hull& hull) {
  const PlanarRows rows(points, filtered);
  const Polygon polygon = rows.hull(run);
  const std::uint64_t edges = polygon.corners.size();
  require_budget(run.budget, edges * 160, std::to_string(edges) + " facets");
  if (edges >= 3 && write_polygon(points, rows.ids, polygon, run.control, run.threads, hull)) {
    hull.affine_dimension = 2;
    std::copy(polygon.rung_counts, polygon.rung_counts + 3, hull.statistics.rung_counts);
    return true;
  }
  filtered.survivors.ids = ascending_ids(polygon.corners.data(), edges, polygon.rows, rows.ids,
                                         run.threads, run.control);
  filtered.survivors.all = false;
  filtered.rows = {};
  return false;
}

/// Few points in space go straight from their coordinates to the result. False: the engine must.
bool few_in_space(const PointView& points, const Survivors& survivors, const Run& run, Hull& hull) {
  constexpr std::uint64_t most_memory = 1 << 22;  // of the largest of such results, generously
  const std::uint64_t count = survivors.size(points.count);
  if (run.options.engine != Engine::native || run.budget < most_memory ||
      (survivors.all && count > most_unfiltered_in_space))
    return false;
  return hull_of_few(points, survivors.all ? nullptr : survivors.ids.data(), count, hull);
}

/// Ascending local ids.
std::vector<std::uint64_t> extreme_locals(const LocalFrame& frame, const Run& run,
                                          std::uint64_t* rung_counts) {
  const LocalPoints& points = frame.points();
  switch (points.dimension) {
    case 0:
      return {0};
    case 1: {
      const SimplicialHull ends = ends_of_line(points);
      return ascending_ids(ends.vertices.data(), 2, points.count, nullptr, 1, run.control);
    }
    case 2: {
      const PointView rows = PointView::row_major(points.exact, points.count, 2);
      const Polygon polygon = polygon_of(rows, false, run.threads, run.control);
      std::copy(polygon.rung_counts, polygon.rung_counts + 3, rung_counts);
      return ascending_ids(polygon.corners.data(), polygon.corners.size(), points.count, nullptr,
                           run.threads, run.control);
    }
    case 3: {
      SimplicialHull hull =
          hull_3d(points, frame.simplex().data(), run.budget, run.threads, run.control);
      std::copy(hull.rung_counts, hull.rung_counts + 3, rung_counts);
      return extreme_rows(std::move(hull), points, run.threads, run.control, rung_counts);
    }
    default: {
      const std::vector<std::uint32_t> ids = extreme_ids(points, run.threads, run.control);
      return {ids.begin(), ids.end()};
    }
  }
}

void extreme_in_space(const PointView& points, Filtered&& filtered, const Run& run,
                      ExtremePoints& result) {
  EngineInput input =
      engine_input(points, std::move(filtered), run.budget, run.threads, run.control);
  const LocalFrame frame(std::move(input.rows), static_cast<std::uint32_t>(input.count),
                         points.dimension, run.threads, run.control);
  result.affine_dimension = frame.affine_dimension();
  result.ids = extreme_locals(frame, run, result.statistics.rung_counts);
  if (input.all) return;
  for (std::uint64_t& v : result.ids) v = input.ids[v];
}

/// What the filter leaves; `run` then has the threads that pay for the hull of it.
Filtered filter_and_plan(const PointView& points, Run& run) {
  const unsigned d = points.dimension;
  Filtered filtered = run_filter(points, run.options, run.control,
                                 useful_cull_threads(run.threads, points.count, d), run.budget);
  run.threads = useful_threads(run.threads, filtered.survivors.size(points.count), d);
  return filtered;
}

/// Qhull decides with tolerances, so what it found must be proven before it is called the hull.
void insist_on_proof(const PointView& points, const Hull& hull, const Options& options) {
  const Certificate certificate = certify(points, hull, options);
  if (!certificate.valid)
    throw Error(ErrorCode::not_exact, "Qhull's result is not the exact hull (" +
                                          certificate.reason + "); use the native engine");
}

}  // namespace

void check_arguments(const PointView& points, const Options& options) {
  if (points.dimension == 0)
    throw Error(ErrorCode::invalid_argument, "points need at least one dimension");
  if (points.data == nullptr && points.count > 0)
    throw Error(ErrorCode::invalid_argument, "points.data is null");
  if (options.backend == Backend::cuda) require_cuda(options.device);
  if (options.engine == Engine::qhull && !qhull_available())
    throw Error(ErrorCode::backend_unavailable,
                "this build has no Qhull engine; use the native engine");
}

Hull hull_of_survivors(const PointView& points, Filtered&& filtered, const Run& run, Few few) {
  const Clock::time_point start = Clock::now();
  Hull hull;
  hull.dimension = points.dimension;
  hull.point_count = points.count;
  hull.scalar = points.scalar;
  hull.statistics.threads = run.threads;
  hull.statistics.engine = run.options.engine == Engine::qhull ? "qhull" : "native";
  hull.statistics.survivors = filtered.survivors.size(points.count);
  hull.statistics.cull_method = filtered.survivors.method;
  hull.statistics.cull_reason = filtered.survivors.reason;
  hull.statistics.backend = filtered.survivors.backend;
  if (points.count == 0) return hull;
  if (points.dimension == 2 && run.options.engine == Engine::native &&
      hull_in_plane(points, filtered, run, hull)) {
    hull.statistics.hull_seconds = seconds_since(start);
    return hull;
  }
  if (few == Few::at_once && few_in_space(points, filtered.survivors, run, hull)) {
    hull.statistics.hull_seconds = seconds_since(start);
    return hull;
  }

  EngineInput input =
      engine_input(points, std::move(filtered), run.budget, run.threads, run.control);
  const LocalFrame frame(std::move(input.rows), static_cast<std::uint32_t>(input.count),
                         points.dimension, run.threads, run.control);
  run.control.check();
  hull.affine_dimension = frame.affine_dimension();
  if (hull.affine_dimension == 0) {
    hull.vertices = {input.all ? 0 : input.ids[0]};
    for (unsigned j = 0; j < points.dimension; ++j)
      hull.centroid.push_back(points.at(hull.vertices[0], j));
  } else {
    const ResultInput from{&points, &frame.points(), input.all ? nullptr : input.ids.data(),
                           frame.axes().data()};
    const auto finish = [&](auto&& boundary, std::uint64_t facets) {
      std::copy(boundary.rung_counts, boundary.rung_counts + 3, hull.statistics.rung_counts);
      const auto k = static_cast<std::uint64_t>(hull.affine_dimension);
      require_budget(run.budget, facets * result_bytes_per_facet(k, points.dimension),
                     std::to_string(facets) + " facets");
      // From 4D on a facet takes some 150 ns: with fewer of them threads cost more than they save.
      constexpr std::uint64_t worth_threads = std::uint64_t{1} << 14;
      build_hull(from, std::move(boundary), run.control,
                 k > 3 && facets < worth_threads ? 1 : run.threads, hull);
    };
    if (hull.affine_dimension == 3 && run.options.engine == Engine::native) {
      Surface3D surface =
          surface_3d(frame.points(), frame.simplex().data(), run.budget, run.threads, run.control);
      finish(std::move(surface), surface.live);
    } else {
      SimplicialHull boundary =
          run_engine(frame, run.options.engine, run.budget, run.threads, run.control);
      finish(std::move(boundary), boundary.facet_count());
    }
  }
  if (run.options.engine == Engine::qhull) insist_on_proof(points, hull, run.options);
  hull.statistics.hull_seconds = seconds_since(start);
  return hull;
}

}  // namespace internal

using namespace internal;

Survivors cull(const PointView& points, const Options& options) {
  check_arguments(points, options);
  const Control control(options);
  const unsigned threads = resolve_threads(options.threads);
  const std::uint64_t budget = resolve_budget(options.memory_budget);
  const auto start = Clock::now();
  Filtered filtered = run_filter(points, options, control, threads, budget);
  Survivors& s = filtered.survivors;
  // Gathering is what finds a NaN: here as in convex_hull, no bad point may pass.
  if (filtered.rows.empty()) check_finite(points, s.all ? nullptr : &s.ids, threads, control);
  s.seconds = seconds_since(start);
  return std::move(s);
}

Hull convex_hull(const PointView& points, const Options& options) {
  check_arguments(points, options);
  if (Hull hull; small_hull(points, options, hull)) return hull;
  Run run(options);
  const unsigned threads = run.threads;  // at hand: those that pay are planned stage by stage
  const CallScope call;
  const PageScope pages;
  const auto start = Clock::now();
  run.control.check();
  Filtered filtered = filter_and_plan(points, run);
  const double cull_seconds = seconds_since(start);
  Hull hull = hull_of_survivors(points, std::move(filtered), run);
  hull.statistics.threads = threads;
  hull.statistics.cull_seconds = cull_seconds;
  hull.statistics.compute_seconds = seconds_since(start);
  run.control.report("done", 1);
  return hull;
}

ExtremePoints extreme_points(const PointView& points, const Options& options) {
  check_arguments(points, options);
  Run run(options);
  const CallScope call;
  const PageScope pages;
  const auto start = Clock::now();

  ExtremePoints result;
  Statistics& statistics = result.statistics;
  statistics.threads = run.threads;
  run.control.check();
  if (points.count == 0) return result;
  Filtered filtered = filter_and_plan(points, run);
  statistics.survivors = filtered.survivors.size(points.count);
  statistics.cull_method = filtered.survivors.method;
  statistics.cull_seconds = seconds_since(start);

  const auto search_start = Clock::now();
  if (points.dimension == 2)
    extreme_in_plane(points, std::move(filtered), run, result);
  else
    extreme_in_space(points, std::move(filtered), run, result);
  statistics.hull_seconds = seconds_since(search_start);
  statistics.compute_seconds = seconds_since(start);
  run.control.report("done", 1);
  return result;
}

}  // namespace cullhull
