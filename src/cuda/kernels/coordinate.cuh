// Coordinates of a view, read by kernels where they lie, and launches by its types.
#pragma once

#include <cstddef>
#include <cstdint>

#include "cullhull/device_points.hpp"
#include "parallel/dispatch.hpp"

namespace cullhull::internal {

template <class T>
__device__ T coordinate(const DevicePointView& p, std::uint64_t point, unsigned axis) {
  return *reinterpret_cast<const T*>(static_cast<const std::byte*>(p.data) +
                                     static_cast<std::ptrdiff_t>(point) * p.point_stride +
                                     static_cast<std::ptrdiff_t>(axis) * p.coordinate_stride);
}

/// use.operator()<T>() for the scalar of points on a device, f32 or f64.
template <class Use>
auto with_device_scalar(const DevicePointView& points, const Use& use) {
  return points.scalar == ScalarType::f32 ? use.template operator()<float>()
                                          : use.template operator()<double>();
}
/// use.operator()<D, T>() for the points' dimension, from `low` to `high`, and scalar.
template <unsigned low, unsigned high, class Use>
auto with_point_types(const DevicePointView& points, const Use& use) {
  return with_dimension<low, high - 1, high>(points.dimension, [&](auto d) {
    return with_device_scalar(points, [&]<class T>() { return use.template operator()<d(), T>(); });
  });
}

/// Blocks of `size` threads for `threads` threads, at most `most`.
inline unsigned blocks_for(std::uint64_t threads, unsigned size, std::uint64_t most = 0x7FFFFFFF) {
  const std::uint64_t blocks = (threads + size - 1) / size;
  return static_cast<unsigned>(blocks < most ? blocks : most);
}

/// body(i) for each i of [0, count), a thread an item.
template <class Body>
__global__ void __launch_bounds__(256)
    each_item(const __grid_constant__ Body body, std::uint64_t count) {
  const std::uint64_t step = std::uint64_t{gridDim.x} * blockDim.x;
  for (std::uint64_t i = std::uint64_t{blockIdx.x} * blockDim.x + threadIdx.x; i < count; i += step)
    body(i);
}
template <class Body>
cudaError_t for_each_item(std::uint64_t count, const Body& body, cudaStream_t stream) {
  if (count == 0) return cudaSuccess;
  each_item<<<blocks_for(count, 256, 8192), 256, 0, stream>>>(body, count);
  return cudaGetLastError();
}

}  // namespace cullhull::internal
