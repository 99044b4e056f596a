// The hull of points in space, in a CUDA device's memory, as far as doubles decide it. Only in
// builds with CUDA.
#pragma once

#include <cstdint>
#include <vector>

#include "cuda/gauge.hpp"
#include "cullhull/device_points.hpp"
#include "filter/star_hull/star_hull.hpp"

namespace cullhull::internal {

struct StarHullThere {
  DeviceIds ids;            ///< of the points that are not culled, ascending, on the device
  StarTriangles triangles;  ///< of these points, on the host, if the surface is whole
  StarCounts counts;
};

/// Grows a star-shaped surface from points in space, at most 2^28 of them, and makes it convex by
/// flips, on points.stream. Needs 100 bytes of device memory a point, and 190 more for each that
/// becomes a vertex. Throws OutOfMemory if there is less, and Failure if the device fails.
StarHullThere star_hull_there(const DevicePointView& points, const Run& run,
                              std::vector<PseudoHullRound>* rounds = nullptr);

}  // namespace cullhull::internal
