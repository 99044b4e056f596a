// Coordinates of a view, read by kernels where they lie.
#pragma once

#include <cstddef>
#include <cstdint>

#include "cullhull/device_points.hpp"

namespace cullhull::internal {

template <class T>
__device__ T coordinate(const DevicePointView& p, std::uint64_t point, unsigned axis) {
  return *reinterpret_cast<const T*>(static_cast<const std::byte*>(p.data) +
                                     static_cast<std::ptrdiff_t>(point) * p.point_stride +
                                     static_cast<std::ptrdiff_t>(axis) * p.coordinate_stride);
}

}  // namespace cullhull::internal
