#include "flow/cull_pass.hpp"

#include "cuda/backend.hpp"
#include "cull/planner.hpp"

namespace cullhull::internal {

FirstPass::FirstPass(const PointView& points, const Options& options, unsigned threads)
    : points_(points),
      threads_(threads),
      ordinal_(options.device),
      insists_(options.backend == Backend::cuda) {
  if (options.backend == Backend::cpu) {
    reason_ = "CPU as asked";
  } else if (insists_) {
    device_ = true;
    reason_ = "CUDA device as asked";
  } else {
    ask_planner(options);
  }
}

std::uint32_t FirstPass::most_nodes() const { return device_ ? cuda::most_map_nodes(ordinal_) : 0; }

void FirstPass::cull(const GaugeMap& map, const Control& control, Survivors& result,
                     SurvivorRows* rows) {
  result.ids = survivors(map, control, rows);
  result.all = false;
  result.backend = device_ ? "cuda" : "cpu";
  result.reason += "; " + reason_;
}

std::vector<std::uint64_t> FirstPass::survivors(const GaugeMap& map, const Control& control,
                                                SurvivorRows* rows) {
  if (device_) {
    try {
      return cuda::survivors_there(map, points_, ordinal_, threads_, control);
    } catch (const cuda::OutOfMemory& e) {
      if (insists_) throw;
      fall_back(e);
    } catch (const cuda::Failure& e) {
      if (insists_) throw;
      fall_back(e);
    }
  }
  return map.survivors(points_, threads_, control, rows);
}

void FirstPass::ask_planner(const Options& options) {
  PlaceQuestion question;
  question.count = points_.count;
  question.dimension = points_.dimension;
  question.point_bytes = points_.dimension * scalar_size(points_.scalar);
  question.threads = threads_;
  question.device_started = cuda_started();
  question.pinned_bytes = kept_pinned_memory();
  const Placement place = choose_place(question, options.machine);
  // What a device would take is told only where there may be one.
  reason_ = cuda_in_sight() ? place.reason : place.host_reason;
  device_ = place.device;
  if (!device_) return;
  reason_ = place.host_reason;
  try {
    require_cuda(ordinal_);
    reason_ = place.reason;
  } catch (const Error& e) {
    fall_back(e);
  }
}

void FirstPass::fall_back(const Error& e) {
  device_ = false;
  reason_ += std::string(", but ") + e.what();
}

}  // namespace cullhull::internal
