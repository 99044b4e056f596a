// The flow for points in a device's memory: cull them on the device, hull the survivors on the
// host, and translate their ids back.
#include <utility>

#include "cullhull/device_hull.hpp"
#include "cullhull/device_points.hpp"
#include "cullhull/error.hpp"
#include "cullhull/hull.hpp"
#include "few/few_points.hpp"
#include "filter/planner.hpp"
#include "flow/pipeline.hpp"
#include "parallel/threads/run.hpp"
#include "result/vertex_coordinates.hpp"

namespace cullhull::internal {

namespace {

Filtered filtered_on_device(const DevicePointView& points, const Options& options,
                            const DeviceRequest& request) {
  check_arguments(points);
  const Run run(options);
  run.check();
  return run_device_filter(points, run, request);
}

PointView rows_on_host(const Filtered& filtered, const DevicePointView& points) {
  return PointView::row_major(filtered.rows.data(), points.count, points.dimension);
}

Options for_cpu(Options options) {
  options.backend = Backend::cpu;
  return options;
}

/// Hull::rename by all threads: of a million vertices it took one thread 15 to 25 ms.
void number_by(const std::vector<std::uint64_t>& ids, const Run& run, Hull& hull) {
  const auto number = [&](auto& positions) {
    run.each(positions.size(), light_grain, [&](std::uint64_t begin, std::uint64_t end) {
      for (std::uint64_t i = begin; i < end; ++i) positions[i] = ids[positions[i]];
    });
  };
  const bool shared = hull.facets.items.shares(hull.simplices);
  number(hull.vertices);
  if (shared) hull.facets.items = {};
  number(hull.simplices.edit());
  if (shared)
    hull.facets.items = hull.simplices;
  else
    number(hull.facets.items.edit());
}

void add_reason(std::string& reason, const Filtered& filtered) {
  if (!filtered.survivors.reason.empty()) reason += "; " + filtered.survivors.reason;
}

/// The hull of what a filter left, on the device or to the CPU.
Hull hull_of_filtered(Filtered&& filtered, const DevicePointView& points, const Options& options) {
  if (!filtered.on_host) return hull_of_rows(std::move(filtered), points, options);
  Hull hull = convex_hull(rows_on_host(filtered, points), for_cpu(options));
  hull.scalar = points.scalar;
  add_reason(hull.statistics.cull_reason, filtered);
  return hull;
}

}  // namespace

void check_arguments(const DevicePointView& points) {
  require_points(points.dimension, points.data, points.count);
  if (points.scalar != ScalarType::f32 && points.scalar != ScalarType::f64)
    throw Error(ErrorCode::invalid_argument, "points on a device must be f32 or f64");
}

Hull hull_of_rows(Filtered&& filtered, const DevicePointView& points, const Options& options) {
  const Survivors& s = filtered.survivors;
  const std::uint64_t count = s.size(points.count);
  const Call call(options);
  Run run = call.run;
  run.threads = useful_threads(run.threads, count, points.dimension);
  const PointView rows = PointView::row_major(filtered.rows.data(), count, points.dimension);
  Hull hull;
  if (!filtered.triangles.empty()) {
    Array<double> kept = std::move(filtered.rows);
    hull = hull_of_lists(std::move(filtered), rows, points.count, run);
    if (options.with_coordinates) hull.vertex_coordinates = std::move(kept);
  } else {
    Filtered unfiltered;
    unfiltered.survivors.all = true;
    if (!small_hull(rows, options, hull))
      hull = hull_of_survivors(rows, std::move(unfiltered), run);
    std::string& way = hull.statistics.cull_reason;
    way = way.empty() ? s.reason : s.reason + "; then " + way;
    if (options.with_coordinates) write_coordinates(rows, hull);
    // Survivors ascend by id, so whatever is sorted by position among them is sorted by id.
    if (!s.all) number_by(s.ids, run, hull);
    hull.statistics.survivors = count;
    hull.statistics.filter = s.filter;
    hull.statistics.backend = s.backend;
  }
  hull.statistics.threads = call.run.threads;
  hull.point_count = points.count;
  hull.scalar = points.scalar;
  run.report("done", 1);
  return hull;
}

}  // namespace cullhull::internal

namespace cullhull {

using namespace internal;

Survivors cull(const DevicePointView& points, const Options& options) {
  const auto start = Clock::now();
  Filtered filtered = filtered_on_device(points, options, {.hull = false});
  if (filtered.on_host) {
    Survivors found = cull(rows_on_host(filtered, points), for_cpu(options));
    add_reason(found.reason, filtered);
    filtered.survivors = std::move(found);
  }
  filtered.survivors.seconds = seconds_since(start);
  return std::move(filtered.survivors);
}

Hull convex_hull(const DevicePointView& points, const Options& options,
                 std::vector<double>* vertex_coordinates) {
  const auto start = Clock::now();
  Filtered filtered = filtered_on_device(points, options, {});
  const double cull_seconds = seconds_since(start);
  Options wanted = options;
  wanted.with_coordinates |= vertex_coordinates != nullptr;
  Hull hull = hull_of_filtered(std::move(filtered), points, wanted);
  if (vertex_coordinates != nullptr) {
    vertex_coordinates->assign(hull.vertex_coordinates.begin(), hull.vertex_coordinates.end());
    if (!options.with_coordinates) hull.vertex_coordinates = {};
  }
  hull.statistics.cull_seconds += cull_seconds;
  hull.statistics.compute_seconds = seconds_since(start);
  return hull;
}

DeviceHull convex_hull_on_device(const DevicePointView& points, const Options& options) {
  const auto start = Clock::now();
  Options wanted = options;
  wanted.with_coordinates = false;
  DeviceHull there;
  Filtered filtered = filtered_on_device(points, wanted, {.there = &there});
  const double cull_seconds = seconds_since(start);
  Hull hull;  // where the device has the lists, only measures and statistics
  if (there.memory != nullptr) {
    (void)write_measures(filtered.triangles, hull);
    tell_found(filtered.survivors, there.vertex_count, Run(options).threads, hull.statistics);
  } else {
    hull = hull_of_filtered(std::move(filtered), points, wanted);
    there = copied_to_device(hull, points, wanted);
  }
  there.point_count = points.count;
  there.volume = hull.volume;
  there.area = hull.area;
  there.centroid = std::move(hull.centroid);
  there.statistics = std::move(hull.statistics);
  there.statistics.cull_seconds += cull_seconds;
  there.statistics.compute_seconds = seconds_since(start);
  return there;
}

}  // namespace cullhull
