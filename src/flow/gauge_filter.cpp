#include <algorithm>

#include "filter/gauge/gauge_map.hpp"
#include "filter/planner.hpp"
#include "flow/pipeline.hpp"
#include "flow/sample_map.hpp"
#include "geometry/gather.hpp"
#include "parallel/threads/run.hpp"

namespace cullhull::internal {
namespace {

/// Fetches samples of points in the host's memory.
SampledPoints host_points(const PointView& points, const Run& run) {
  return {points.count, points.dimension, [&points, &run](std::span<const std::uint64_t> ids) {
            return gather_points(points, ids.data(), ids.size(), run);
          }};
}

/// Culls the rows of a first pass's survivors by a second map, if that is worthwhile, and returns
/// the positions of those it leaves. All of them lie near the boundary, so that they give a much
/// finer map. Empty: there is none.
Array<std::uint64_t> pass_again(Filtered& result, unsigned d, const Run& run) {
  const PointView left = view_of_rows(result, d);
  if (left.count < smallest_worth_refining(d)) return {};
  SampledPoints all = host_points(left, run);
  all.lead = [&](const GaugeMap& before, const LeaderCells& cells) {
    return GaugeMap::of_leaders(result.rows, before, cells, run);
  };
  const SampledMap finer = map_of_left(all, result.map.get(), 0, run);
  result.map.reset();
  result.survivors.reason += "; a second map: " + finer.reason;
  if (finer.map == nullptr) return {};
  SurvivorRows gathered;
  Array<std::uint64_t> kept = finer.map->survivors(left, run, &gathered);
  result.rows = std::move(gathered.rows);
  result.survivors.filter = UsedFilter::gauge_twice;
  return kept;
}

/// Runs the pass of a map over all points, and the stages after it.
void cull_by(CullPass& pass, SampledMap sampled, const PointView& points, const Run& run,
             Filtered& result) {
  std::unique_ptr<GaugeMap> map = std::move(sampled.map);
  const unsigned d = points.dimension;
  result.survivors.filter = UsedFilter::gauge;
  SurvivorRows gathered;
  // The most survivors whose rows are copied during the pass. The copy briefly doubles the memory
  // for survivors; where more points survive, gathering them afterwards is as fast.
  gathered.most = std::min(run.budget / (16 * d * sizeof(double)), points.count / 4);
  const Array<std::uint64_t> ids = pass.cull(*map, result.survivors, &gathered);
  if (sampled.led)
    result.map = std::move(map);
  else
    map.reset();
  if (d == 2 && ids.size() > points.count / 10 * 9) {
    // The points are too close together for single precision to separate them. The 2D engine
    // discards inner points in double precision, reading the caller's memory.
    result.survivors.all = true;
    result.survivors.reason += "; it kept nearly all";
    return;
  }
  result.rows = std::move(gathered.rows);

  gather_survivors(points, ids, result, run);
  const Array<std::uint64_t> kept = pass_again(result, d, run);
  std::vector<std::uint64_t>& left = result.survivors.ids;
  if (kept.empty()) {
    left.assign(ids.begin(), ids.end());
  } else {
    left.resize(kept.size());
    run.each(kept.size(), 8192, [&](std::uint64_t begin, std::uint64_t end) {
      for (std::uint64_t i = begin; i < end; ++i) left[i] = ids[kept[i]];
    });
  }
}

}  // namespace

void filter_by_sample(const PointView& points, const Run& run, Filtered& result) {
  const Insist insist = run.options.cull == CullMethod::gauge ? Insist::yes : Insist::no;
  run.report("cull", 0);
  CullPass pass(points, run);
  const auto sample = [&] {
    SampledMap sampled = map_of_sample(
        host_points(points, run), insist, pass.most_nodes(), run,
        pass.on_device() ? most_probes_of_device(points.dimension) : ~std::uint64_t{0});
    result.survivors.reason = sampled.reason;
    return sampled;
  };
  SampledMap sampled;
  try {
    sampled = sample();
    if (pass.on_device()) {
      if (pass.filter_there(sampled.map.get(), result)) {
        if (!result.survivors.all) gather_survivors(points, result.survivors.ids, result, run);
        return;
      }
      sampled = sample();  // the CPU wants another map
    }
  } catch (const Error& e) {
    if (e.code() != ErrorCode::not_finite) throw;
    check_finite(points, nullptr, run);  // reports the first bad point of all, not of the sample
  }
  if (sampled.map == nullptr) return;
  cull_by(pass, std::move(sampled), points, run, result);
}

void refine_survivors(Filtered& result, unsigned d, const Run& run) {
  std::vector<std::uint64_t>& ids = result.survivors.ids;
  const Array<std::uint64_t> kept = pass_again(result, d, run);
  for (std::size_t i = 0; i < kept.size(); ++i) ids[i] = ids[kept[i]];
  if (!kept.empty()) ids.resize(kept.size());
}

}  // namespace cullhull::internal
