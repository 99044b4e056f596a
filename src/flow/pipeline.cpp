// The flow: validate, cull (filter_stage.cpp), hull and result (hull_of_survivors.cpp).
#include "flow/pipeline.hpp"

#include <utility>

#include "cuda/backend.hpp"
#include "cullhull/cull.hpp"
#include "cullhull/error.hpp"
#include "cullhull/hull.hpp"
#include "cullhull/version.hpp"
#include "few/few_points.hpp"
#include "filter/planner.hpp"
#include "geometry/gather.hpp"
#include "parallel/dispatch.hpp"
#include "parallel/memory/pages.hpp"
#include "parallel/threads/helpers.hpp"
#include "parallel/threads/run.hpp"
#include "result/vertex_coordinates.hpp"

namespace cullhull::internal {

void check_arguments(const PointView& points, const Options& options) {
  require_points(points);
  if (options.backend == Backend::cuda) require_cuda(options.device);
}

Filtered filter_and_plan(const PointView& points, Run& run) {
  if constexpr (plane_only) return run_filter(points, run);
  const unsigned d = points.dimension;
  Filtered filtered =
      run_filter(points, run.with_threads(useful_cull_threads(run.threads, points.count, d)));
  run.threads = useful_threads(run.threads, filtered.survivors.size(points.count), d);
  return filtered;
}

}  // namespace cullhull::internal

namespace cullhull {

using namespace internal;

const char* version() noexcept { return CULLHULL_VERSION; }

const char* error_name(ErrorCode code) noexcept {
  static constexpr const char* names[] = {
      "invalid_argument",    "not_finite", "bad_file",  "io",      "out_of_budget",
      "backend_unavailable", "cancelled",  "not_exact", "internal"};
  return names[static_cast<unsigned>(code)];
}

const char* backend_name(Backend backend) noexcept {
  static constexpr const char* names[] = {"automatic", "cpu", "cuda"};
  return names[static_cast<unsigned>(backend)];
}

const char* filter_name(UsedFilter filter) noexcept {
  static constexpr const char* names[] = {
      "none", "gauge", "gauge x2", "pseudo-hull", "gauge, pseudo-hull", "stream"};
  return names[static_cast<unsigned>(filter)];
}

Survivors cull(const PointView& points, const Options& options) {
  check_arguments(points, options);
  const Run run(options);
  const auto start = Clock::now();
  Filtered filtered = run_filter(points, run);
  Survivors& s = filtered.survivors;
  // Gathering checks for NaN; where nothing was gathered, check here, as convex_hull would.
  if (filtered.rows.empty()) check_finite(points, s.all ? nullptr : &s.ids, run);
  s.seconds = seconds_since(start);
  return std::move(s);
}

Hull convex_hull(const PointView& points, const Options& options) {
  check_arguments(points, options);
  Hull hull;  // the only one, so none is moved: that took 3 % of a call with 10 points
  if (small_hull(points, options, hull)) {
    if (options.with_coordinates) write_coordinates(points, hull);
    return hull;
  }
  const Call call(options);
  Run run = call.run;
  const auto start = Clock::now();
  run.check();
  Filtered filtered = filter_and_plan(points, run);
  const double cull_seconds = seconds_since(start);
  hull = hull_of_survivors(points, std::move(filtered), run);
  hull.statistics.threads = call.run.threads;  // a stage may use fewer
  hull.statistics.cull_seconds = cull_seconds;
  if (options.with_coordinates) write_coordinates(points, hull);
  hull.statistics.compute_seconds = seconds_since(start);
  run.report("done", 1);
  return hull;
}

}  // namespace cullhull
