#include "tracker/gauge_scan.hpp"

#include <memory>
#include <utility>

#include "cull/gauge_map.hpp"
#include "pipeline.hpp"
#include "points/gather.hpp"

namespace cullhull::internal {
namespace {

/// Where the scan keeps more than this share the leaders lie badly: then a sample of what is left
/// makes a better second map than they do.
constexpr double coherent_share = 1.0 / 3;

/// Nodes of the scan's map, as a share of what a static run would take. Leaders lie all over the
/// hull, so a coarser map keeps hardly more, and the cones decide what it leaves in doubt.
constexpr double map_share = 0.5;

}  // namespace

bool filter_by_leaders(const PointView& points, const std::vector<std::uint64_t>& leaders,
                       const Run& run, Filtered& result, double& scan_seconds) {
  const auto start = Clock::now();
  const unsigned d = points.dimension;
  std::vector<double> rows;
  try {
    rows = gather_points(points, leaders.data(), leaders.size(), run.threads);
  } catch (const Error& e) {
    if (e.code() != ErrorCode::not_finite) throw;
    check_finite(points, nullptr, run.threads);  // names the first bad point, not the first leader
    throw;
  }
  run.control.report("scan", 0);
  InnerPolytope polytope = inner_polytope(std::move(rows), d, run);
  if (polytope.dimension == 0) return false;
  const std::unique_ptr<GaugeMap> map = GaugeMap::build(
      std::move(polytope), {.share = map_share, .cones = true, .threads = run.threads});
  if (map == nullptr) return false;
  result.survivors.ids = map->survivors(points, run.threads, run.control);
  result.survivors.all = false;
  result.survivors.method = "gauge";
  scan_seconds = seconds_since(start);
  gather_survivors(points, result, run);
  const auto left = static_cast<double>(result.first_pass);
  if (left <= coherent_share * static_cast<double>(points.count))
    keep_of_survivors(result, d, map->outside_cones(result.rows, run.threads, run.control));
  refine_by_sample(result, d, run);
  return true;
}

}  // namespace cullhull::internal
