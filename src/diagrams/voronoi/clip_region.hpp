// Regions to which diagrams are clipped, as convex pieces that do not overlap.
#pragma once

#include <gmpxx.h>

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "cullhull/point_view.hpp"
#include "cullhull/voronoi.hpp"
#include "exact/numbers/bounded.hpp"
#include "parallel/threads/run.hpp"

namespace cullhull::internal {

/// A plane through D given points, or orthogonal to an axis.
template <unsigned D>
struct RegionPlane {
  std::array<std::array<double, D>, D> through;
  int axis = -1;      ///< the axis that the plane is orthogonal to; -1: no axis
  double toward = 1;  ///< -1: the region has larger values of that coordinate; 1: smaller
  std::array<BoundedDoubleDouble, D> normal;  ///< outward
};

/// The outward normal. 2D: the region is on the left of the direction from the first point to the
/// second. 3D: the points are counterclockwise from outside.
template <unsigned D, class Real>
std::array<Real, D> normal_of(const RegionPlane<D>& plane);

/// A convex polytope. 1D: both ends. 2D: corners counterclockwise; plane i contains the edge from
/// corner i to the next. 3D: faces counterclockwise from outside.
template <unsigned D>
struct RegionPiece {
  std::vector<std::array<double, D>> corners;
  std::vector<RegionPlane<D>> planes;
  std::vector<std::vector<std::uint32_t>> faces;  ///< D = 3: the corners on each plane
  std::vector<std::uint32_t> across;              ///< the piece beyond each plane, or no_index

  /// Whether a point whose coordinates are the nearest doubles `rounded` is certainly inside.
  bool surely_inside(const double* rounded) const;
};

template <unsigned D>
using Region = std::vector<RegionPiece<D>>;

template <unsigned D>
Region<D> box_region(std::span<const double> low, std::span<const double> high);

/// The convex hull of points; D = 1 or 3.
template <unsigned D>
Region<D> hull_region(const PointView& points, const Run& run);

/// One or several polygons, not necessarily convex, with holes: one piece if the region is convex
/// and has few corners, otherwise the triangles of its constrained triangulation.
Region<2> polygon_region(const PointView& corners, std::span<const std::uint64_t> ring_offsets,
                         const Run& run);

}  // namespace cullhull::internal
