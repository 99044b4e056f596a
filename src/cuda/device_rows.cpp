#include "cuda/device_rows.hpp"

#include <memory>
#include <string>

#include "cuda/gauge.hpp"
#include "cuda/kernels/gauge_kernel.hpp"
#include "cuda/result_memory.hpp"
#include "cuda/runtime.hpp"
#include "geometry/gather.hpp"
#include "parallel/threads/run.hpp"

namespace cullhull::internal {

int device_of_memory(const void* memory, const char* what) {
  cudaPointerAttributes attributes = {};
  const cudaError_t status = cudaPointerGetAttributes(&attributes, memory);
  if (status != cudaSuccess) {
    (void)this_device();  // throws the reason if there is no device
    check(status, "asking where the points are");
  }
  if (attributes.type != cudaMemoryTypeDevice && attributes.type != cudaMemoryTypeManaged)
    throw Error(ErrorCode::invalid_argument, what,
                " not in a CUDA device's memory; use PointView for host memory");
  return attributes.device;
}

int device_of(const DevicePointView& points) {
  const int device = device_of_memory(points.data);
  const auto size = static_cast<std::ptrdiff_t>(scalar_size(points.scalar));
  if (reinterpret_cast<std::uintptr_t>(points.data) % static_cast<std::uintptr_t>(size) != 0 ||
      points.point_stride % size != 0 || points.coordinate_stride % size != 0)
    throw Error(ErrorCode::invalid_argument,
                "points and strides on a device must be aligned to the scalar's size");
  refuse_capture(static_cast<cudaStream_t>(points.stream));
  return device;
}

Placement place_of_device_points(const DevicePointView& points, const Run& run) {
  PlaceQuestion question;
  question.count = points.count;
  question.dimension = points.dimension;
  question.point_bytes = points.dimension * scalar_size(points.scalar);
  question.threads = run.threads;
  question.on_device = true;
  return choose_place(question);
}

Array<double> download_all(const DevicePointView& points, const Run& run) {
  require_budget(run.budget, points.count * points.dimension * 2 * sizeof(double),
                 std::to_string(points.count) + " points copied from the device");
  Array<double> rows = download_points(points, nullptr, points.count, run);
  check_rows_finite(rows.data(), points.count, points.dimension, nullptr, run);
  return rows;
}

void refuse_first_not_finite(const DevicePointView& points, const Run& run) {
  const auto stream = static_cast<cudaStream_t>(points.stream);
  unsigned long long first = ~0ULL;
  const DeviceArray<unsigned long long> found(1, stream);
  upload(found.data(), &first, 1, stream);
  check(first_not_finite(points, found.data(), stream), "looking for NaN");
  download(&first, found.data(), 1, stream);
  if (first < points.count) {
    const std::uint64_t id = first;
    const Array<double> row = download_points(points, &id, 1, run);
    check_rows_finite(row.data(), 1, points.dimension, &id, run);
  }
  throw Error(ErrorCode::internal, "points on the device changed during the call");
}

}  // namespace cullhull::internal

namespace cullhull {

Array<double> fetch_points(const DevicePointView& points, std::span<const std::uint64_t> ids) {
  using namespace internal;
  for (const std::uint64_t id : ids)
    if (id >= points.count)
      throw Error(ErrorCode::invalid_argument, "there is no point ", id, " of ", points.count);
  if (ids.empty()) {
    (void)this_device();
    return {};
  }
  if (points.scalar != ScalarType::f32 && points.scalar != ScalarType::f64)
    throw Error(ErrorCode::invalid_argument, "points on a device must be f32 or f64");
  const DeviceScope scope(device_of(points));
  return download_points(points, ids.data(), ids.size(), short_run());
}

DeviceMemory device_memory(const DevicePointView& points, std::uint64_t bytes) {
  using namespace internal;
  const DeviceScope scope(points.count > 0 ? device_of(points) : this_device().ordinal);
  const auto memory =
      std::make_shared<ResultMemory>(bytes, static_cast<cudaStream_t>(points.stream));
  return {{memory, memory->data()}, memory->device()};
}

void wait_for_cuda_device_of(const void* memory) {
  using namespace internal;
  const DeviceScope scope(device_of_memory(memory));
  check(cudaDeviceSynchronize(), "waiting for the device that holds the points");
}

}  // namespace cullhull
