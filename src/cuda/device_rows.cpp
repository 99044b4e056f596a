#include "cuda/device_rows.hpp"

#include <algorithm>
#include <numeric>
#include <string>
#include <vector>

#include "cuda/gauge.hpp"
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
  const int ordinal = device_of_memory(points.data);
  const auto size = static_cast<std::ptrdiff_t>(scalar_size(points.scalar));
  if (reinterpret_cast<std::uintptr_t>(points.data) % static_cast<std::uintptr_t>(size) != 0 ||
      points.point_stride % size != 0 || points.coordinate_stride % size != 0)
    throw Error(ErrorCode::invalid_argument,
                "points and strides on a device must be aligned to the scalar's size");
  refuse_capture(cuda_stream_of(points));
  return device(ordinal).ordinal;
}

Placement place_of_device_points(const DevicePointView& points, const Run& run) {
  return choose_place({.count = points.count,
                       .dimension = points.dimension,
                       .point_bytes = points.dimension * scalar_size(points.scalar),
                       .threads = run.threads,
                       .on_device = true});
}

Array<double> download_all(const DevicePointView& points, const Run& run) {
  require_budget(run.budget, points.count * points.dimension * 2 * sizeof(double),
                 std::to_string(points.count) + " points copied from the device");
  return download_finite(points, nullptr, points.count, nullptr, run);
}

Array<double> download_finite(const DevicePointView& points, const std::uint64_t* ids,
                              std::uint64_t count, const std::uint64_t* names, const Run& run) {
  Array<double> rows = download_points(points, ids, count, run);
  check_rows_finite(rows.data(), count, points.dimension, names, run);
  return rows;
}

Array<double> gather_from_device(const DevicePointView& view, std::span<const std::uint64_t> ids,
                                 const DevicePointView& all, const Run& run) {
  const Array<double> rows = download_points(view, ids.data(), ids.size(), run);
  try {
    return gather_points(PointView::row_major(rows.data(), ids.size(), view.dimension), nullptr,
                         ids.size(), run);
  } catch (const Error& e) {
    if (e.code() != ErrorCode::not_finite) throw;
  }
  refuse_first_not_finite(all, run);
}

void require_room_for_survivors(std::uint64_t count, unsigned dimension, const Run& run) {
  require_budget(run.budget, count * (dimension + 2) * sizeof(double),
                 std::to_string(count) + " points that survive the filter");
}

void refuse_first_not_finite(const DevicePointView& points, const Run& run) {
  constexpr std::uint64_t piece = 1 << 20;
  for (std::uint64_t first = 0; first < points.count; first += piece) {
    std::vector<std::uint64_t> names(std::min(piece, points.count - first));
    std::iota(names.begin(), names.end(), first);
    (void)download_finite(part_of(points, first, names.size()), nullptr, names.size(), names.data(),
                          run);
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
  return {result_memory(bytes, cuda_stream_of(points)), this_device().ordinal};
}

void wait_for_cuda_device_of(const void* memory) {
  using namespace internal;
  const DeviceScope scope(device_of_memory(memory));
  check(cudaDeviceSynchronize(), "waiting for the device that holds the points");
}

}  // namespace cullhull
