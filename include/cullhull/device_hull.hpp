// The hull of points in a CUDA device's memory, left there. Needs no CUDA header.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "cullhull/device_points.hpp"
#include "cullhull/hull.hpp"
#include "cullhull/options.hpp"

#pragma GCC visibility push(default)
namespace cullhull {

/// The vertices and simplices of a Hull in a device's memory, its measures on the host. Copies
/// share the memory, which is freed with the last copy, after all work queued on the device by
/// then.
struct DeviceHull {
  std::uint32_t dimension = 0;
  int affine_dimension = -1;  ///< k below
  std::uint64_t point_count = 0, vertex_count = 0, simplex_count = 0;
  double volume = 0, area = 0;   ///< as in Hull
  std::vector<double> centroid;  ///< as in Hull
  int device = -1;
  const std::int64_t* vertices = nullptr;    ///< ids, as Hull::vertices
  const std::int64_t* simplices = nullptr;   ///< simplex_count x k ids, as Hull::simplices
  const std::int32_t* neighbours = nullptr;  ///< of the same shape, as Hull::simplex_neighbours
  /// simplex_count x (dimension + 1): the plane of each simplex's facet, as in Hull::facet_planes.
  const double* planes = nullptr;
  std::shared_ptr<const void> memory;  ///< holds all of these
  Statistics statistics;
};

/// The exact hull of points in a device's memory: every number has the bits of
/// convex_hull(DevicePointView). In space the device finds the hull, decides that it is the hull
/// and writes it (docs/gpu.md, "The hull in space"), and only measures are copied to the host,
/// where doubles decide every edge; else, as of points of which four lie in a plane, in other
/// dimensions and with Backend::cpu, the hull is computed as by convex_hull and copied back. All
/// data are written when the call returns. Thread safe. Throws what convex_hull(DevicePointView)
/// throws; Error{out_of_budget} if the device's memory is full.
DeviceHull convex_hull_on_device(const DevicePointView& points, const Options& options = {});

}  // namespace cullhull
#pragma GCC visibility pop
