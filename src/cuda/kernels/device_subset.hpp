// What the filters on a device share that grow a surface from the rows of a subset.
#pragma once

#include <cstdint>

#include "cullhull/device_points.hpp"
#include "filter/pseudo_hull/pseudo_hull_rows.hpp"
#include "parallel/host_device.hpp"

namespace cullhull::internal {

struct EmitId {
  PseudoSubset subset;
  std::uint64_t* ids;
  CULLHULL_HD void operator()(std::uint32_t i, std::uint32_t k) const { ids[k] = subset.point(i); }
};

/// The same memory as a view of points; only a device can read it.
inline PointView as_point_view(const DevicePointView& points) {
  return {static_cast<const std::byte*>(points.data),
          points.scalar,
          points.dimension,
          points.count,
          points.point_stride,
          points.coordinate_stride};
}

}  // namespace cullhull::internal
