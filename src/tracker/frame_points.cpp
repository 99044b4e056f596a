#include "tracker/frame_points.hpp"

#include <utility>

#include "cullhull/error.hpp"
#include "cullhull/hull.hpp"
#include "filter/planner.hpp"
#include "flow/pipeline.hpp"
#include "geometry/gather.hpp"
#include "parallel/threads/run.hpp"
#include "result/vertex_coordinates.hpp"

namespace cullhull::internal {

HostFrame::HostFrame(const PointView& points, const Run& run)
    : FramePoints(points.count, points.dimension), points_(points), run_(run) {
  check_arguments(points, run.options);
}

CullPass& HostFrame::pass() {
  if (!pass_) pass_.emplace(points_, run_);
  return *pass_;
}

Array<double> gather_of_frame(const PointView& points, const std::vector<std::uint64_t>& ids,
                              const Run& run) {
  try {
    return gather_points(points, ids.data(), ids.size(), run);
  } catch (const Error& e) {
    if (e.code() != ErrorCode::not_finite) throw;
    check_finite(points, nullptr, run);  // names the first bad point of all points
    throw;
  }
}

Array<double> HostFrame::gather(const std::vector<std::uint64_t>& ids) {
  return gather_of_frame(points_, ids, run_);
}

std::uint32_t HostFrame::most_nodes() { return pass().most_nodes(); }

void HostFrame::scan(const GaugeMap& map, Survivors& result) {
  const Array<std::uint64_t> ids = pass().cull(map, result);
  result.ids.assign(ids.begin(), ids.end());
}

void HostFrame::fetch(Filtered& result) {
  gather_survivors(points_, result.survivors.ids, result, run_);
}

Filtered HostFrame::filter_afresh() {
  const unsigned threads = useful_cull_threads(run_.threads, points_.count, points_.dimension);
  return run_filter(points_, run_.with_threads(threads));
}

Hull HostFrame::hull(Filtered&& filtered) {
  const unsigned threads =
      useful_threads(run_.threads, filtered.survivors.size(points_.count), points_.dimension);
  Hull hull = hull_of_survivors(points_, std::move(filtered), run_.with_threads(threads), &known);
  if (run_.options.with_coordinates) write_coordinates(points_, hull);
  hull.statistics.threads = run_.threads;
  return hull;
}

}  // namespace cullhull::internal
