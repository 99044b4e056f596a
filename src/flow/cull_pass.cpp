#include "cuda/backend.hpp"
#include "filter/planner.hpp"
#include "flow/pipeline.hpp"
#include "flow/sample_map.hpp"
#include "parallel/threads/run.hpp"

namespace cullhull::internal {

CullPass::CullPass(const PointView& points, const Run& run)
    : points_(points), run_(run), insists_(run.options.backend == Backend::cuda) {
  if (run.options.backend == Backend::cpu) {
    reason_ = "CPU as asked";
  } else if (insists_) {
    device_ = true;
    reason_ = "CUDA device as asked";
  } else {
    ask_planner();
  }
}

std::uint32_t CullPass::most_nodes() const {
  return device_ ? most_map_nodes(run_.options.device) : 0;
}

Array<std::uint64_t> CullPass::cull(const GaugeMap& map, Survivors& result, SurvivorRows* rows) {
  Array<std::uint64_t> ids = survivors(map, rows);
  result.all = false;
  result.backend = device_ ? Backend::cuda : Backend::cpu;
  result.reason += "; " + reason_;
  return ids;
}

bool CullPass::filter_there(const GaugeMap* map, Filtered& result) {
  return tried_there([&] { internal::filter_there(points_, map, reason_, run_, result); });
}

Array<std::uint64_t> CullPass::survivors(const GaugeMap& map, SurvivorRows* rows) {
  Array<std::uint64_t> ids;
  if (tried_there([&] { ids = survivors_there(map.table(), points_, run_); })) return ids;
  return map.survivors(points_, run_, rows);
}

template <class There>
bool CullPass::tried_there(const There& there) {
  if (!device_) return false;
  try {
    there();
  } catch (const OutOfMemory& e) {
    if (insists_) throw;
    fall_back(e);
  } catch (const Failure& e) {
    if (insists_) throw;
    fall_back(e);
  }
  return device_;
}

void CullPass::ask_planner() {
  PlaceQuestion question;
  question.count = points_.count;
  question.dimension = points_.dimension;
  question.point_bytes = points_.dimension * scalar_size(points_.scalar);
  question.threads = run_.threads;
  question.device_started = cuda_started();
  question.pinned_bytes = kept_pinned_memory();
  const Placement place = choose_place(question);
  // The device's estimate is reported only where there may be a device.
  reason_ = cuda_in_sight() ? place.reason : place.host_reason;
  device_ = place.device;
  if (!device_) return;
  reason_ = place.host_reason;
  try {
    require_cuda(run_.options.device);
    reason_ = place.reason;
  } catch (const Error& e) {
    fall_back(e);
  }
}

void CullPass::fall_back(const Error& e) {
  device_ = false;
  reason_ += std::string(", but ") + e.what();
}

}  // namespace cullhull::internal
