#include "tracker/frame_points.hpp"

#include <utility>

#include "cullhull/error.hpp"
#include "flow/device_filter.hpp"
#include "flow/pipeline.hpp"
#include "geometry/gather.hpp"

namespace cullhull::internal {

HostFrame::HostFrame(const PointView& points, const Run& run)
    : FramePoints(points.count, points.dimension), points_(points), run_(run) {
  check_arguments(points, run.options);
}

FirstPass& HostFrame::pass() {
  if (!pass_) pass_.emplace(points_, run_.options, run_.threads);
  return *pass_;
}

Array<double> HostFrame::gather(const std::vector<std::uint64_t>& ids) {
  try {
    return gather_points(points_, ids.data(), ids.size(), run_.threads, run_.control);
  } catch (const Error& e) {
    if (e.code() != ErrorCode::not_finite) throw;
    check_finite(points_, nullptr, run_.threads, run_.control);  // names the first bad point of all
    throw;
  }
}

std::uint32_t HostFrame::most_nodes() { return pass().most_nodes(); }

void HostFrame::scan(const GaugeMap& map, Survivors& result) {
  pass().cull(map, run_.control, result);
}

void HostFrame::fetch(Filtered& result) {
  gather_survivors(points_, result, run_.control, run_.threads, run_.budget);
}

Filtered HostFrame::filter_afresh() {
  return run_filter(points_, run_.options, run_.control, run_.threads, run_.budget);
}

Hull HostFrame::hull(Filtered&& filtered) {
  return hull_of_survivors(points_, std::move(filtered), run_);
}

}  // namespace cullhull::internal
