// The CUDA backend in builds without CUDA: functions report that it was not compiled.
#include "cuda/backend.hpp"
#include "cuda/hull_questions.hpp"
#include "cuda/set_hulls.hpp"
#include "cullhull/device_points.hpp"
#include "flow/pipeline.hpp"
#include "tracker/frame_points.hpp"

namespace cullhull::internal {
namespace {

[[noreturn]] void refuse_cuda() {
  throw Error(ErrorCode::backend_unavailable,
              "this build has no CUDA backend; use the backend auto or cpu");
}

}  // namespace

void require_cuda(int) { refuse_cuda(); }
bool cuda_started() noexcept { return false; }
std::size_t kept_pinned_memory() noexcept { return 0; }
void drop_device_memory() noexcept {}
bool cuda_in_sight() noexcept { return false; }

std::uint32_t most_map_nodes(int) { refuse_cuda(); }

Array<std::uint64_t> survivors_there(const GaugeTable&, const PointView&, const Run&) {
  refuse_cuda();
}

std::unique_ptr<SetsOnDevice> sets_on_device(const DevicePointView&, const Run&) { refuse_cuda(); }

std::unique_ptr<QuestionsOnDevice> questions_on_device(const DevicePointView&, const HullTables*,
                                                       KeptTables&, const Options&) {
  refuse_cuda();
}

Filtered run_device_filter(const DevicePointView&, const Run&, const DeviceRequest&) {
  refuse_cuda();
}

DeviceHull copied_to_device(const Hull&, const DevicePointView&, const Options&) { refuse_cuda(); }

void filter_there(const PointView&, const GaugeMap*, const std::string&, const Run&, Filtered&) {
  refuse_cuda();
}

std::unique_ptr<FramePoints> device_frame(const DevicePointView& points, const Run&,
                                          std::shared_ptr<LastSurface>&) {
  check_arguments(points);
  refuse_cuda();
}

}  // namespace cullhull::internal

namespace cullhull {

int current_cuda_device() noexcept { return -1; }
int chosen_cuda_device() noexcept { return -1; }
Array<double> fetch_points(const DevicePointView&, std::span<const std::uint64_t>) {
  internal::refuse_cuda();
}
DeviceMemory device_memory(const DevicePointView&, std::uint64_t) { internal::refuse_cuda(); }
std::shared_ptr<void> device_stream(int) { internal::refuse_cuda(); }
void wait_for_cuda_stream(void*) { internal::refuse_cuda(); }
void wait_for_cuda_device_of(const void*) { internal::refuse_cuda(); }

CudaStatus cuda_status() {
  CudaStatus status;
  try {
    internal::refuse_cuda();
  } catch (const Error& e) {
    status.reason = e.what();
  }
  return status;
}

}  // namespace cullhull
