// The hull of points in space, in a CUDA device's memory, as far as doubles decide it. Only in
// builds with CUDA.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "cuda/gauge.hpp"
#include "cullhull/device_hull.hpp"
#include "cullhull/device_points.hpp"
#include "filter/star_hull/star_hull.hpp"
#include "result/write/star_result.hpp"

namespace cullhull::internal {

/// Where the hull is wanted that a surface may be.
enum class HullPlace { nowhere, host, device };

struct StarHullThere {
  DeviceIds ids;  ///< of the points that are not culled, ascending, on the device
  /// Their hull, if asked for and decided by doubles; without its lists where they are `left`.
  StarLists lists;
  std::shared_ptr<const void> left;  ///< the lists on the device, if the hull is wanted there
  const std::uint32_t *vertices = nullptr, *neighbours = nullptr;
  const double* planes = nullptr;
  StarCounts counts;
};

/// Whether the surface of all these points is worth its time, without a map before it: on a sphere
/// of 100,000 points it gains a quarter, with 16 threads; fewer are untested.
inline bool surface_of_all_pays(unsigned d, std::uint64_t count, const Run& run) {
  return d == 3 && count <= pseudo_hull_most_points &&
         (run.options.backend == Backend::cuda || count >= std::uint64_t{1} << 16);
}

/// Memory of a device that holds the surface of the last frame, of whatever scalar type.
struct LastSurface {
  CudaStream stream;  ///< its own: the caller's may end before the next frame
  int device = -1;
  ScalarType scalar = ScalarType::f32;
  bool kept = false;  ///< else memory alone: the last frame's was not whole
  virtual ~LastSurface() = default;
};

struct StarRequest {
  HullPlace place = HullPlace::host;
  bool rows = true;  ///< to the host, the vertices' rows as well
  StarBegin begin = StarBegin::any;
  std::shared_ptr<LastSurface>* last = nullptr;    ///< of a tracker's
  std::vector<PseudoHullRound>* rounds = nullptr;  ///< to report to
};

/// Grows a star-shaped surface from points in space, at most 2^28 of them, and makes it convex by
/// flips, on points.stream; or, if request.last is given, on that surface's own stream, from that
/// surface if as many points follow, and leaves there the new one if it is whole. Needs 100 bytes
/// of device memory a point, and 230 more for each that becomes a vertex; 200 more if the hull is
/// wanted, which there is none of without them. Throws OutOfMemory if there is less, and Failure if
/// the device fails.
StarHullThere star_hull_there(const DevicePointView& points, const Run& run,
                              const StarRequest& request = {});

/// Makes a hull on the device of the lists in found.left and the ids of its vertices.
void leave_there(const StarHullThere& found, const DeviceIds& ids, cudaStream_t stream,
                 DeviceHull& hull);
/// Kernel: the ids of `count` corners.
void name_corners(const std::uint32_t* corners, const DeviceIds& ids, std::uint32_t count,
                  std::int64_t* named, cudaStream_t stream);

}  // namespace cullhull::internal
