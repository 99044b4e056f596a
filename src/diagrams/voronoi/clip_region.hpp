// Regions to which diagrams are clipped, as convex pieces that do not overlap.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "cullhull/point_view.hpp"
#include "cullhull/voronoi.hpp"
#include "exact/numbers/bounded.hpp"
#include "exact/numbers/gmpxx.hpp"

namespace cullhull::internal {

struct Run;
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
std::array<Real, D> normal_of(const RegionPlane<D>& plane) {
  std::array<Real, D> n;
  if (plane.axis >= 0) {
    for (unsigned j = 0; j < D; ++j)
      n[j] = Real(static_cast<int>(j) == plane.axis ? plane.toward : 0.0);
    return n;
  }
  std::array<std::array<Real, D>, 2> e;
  for (unsigned i = 1; i < D; ++i)
    for (unsigned j = 0; j < D; ++j)
      e[i - 1][j] = exact_difference<Real>(plane.through[i][j], plane.through[0][j]);
  if constexpr (D == 2) {
    n[0] = e[0][1];
    n[1] = -e[0][0];
  } else if constexpr (D == 3) {
    for (unsigned j = 0; j < 3; ++j) {
      const unsigned k = (j + 1) % 3, l = (j + 2) % 3;
      n[j] = e[0][k] * e[1][l] - e[0][l] * e[1][k];
    }
  }
  return n;
}

/// A convex polytope. 1D: both ends. 2D: corners counterclockwise; plane i contains the edge from
/// corner i to the next. 3D: faces counterclockwise from outside.
template <unsigned D>
struct RegionPiece {
  std::vector<std::array<double, D>> corners;
  std::vector<RegionPlane<D>> planes;
  std::vector<std::vector<std::uint32_t>> faces;  ///< D = 3: the corners on each plane
  std::vector<std::uint32_t> across;              ///< the piece beyond each plane, or no_index

  /// Whether a point whose coordinates are the nearest doubles `rounded` is certainly inside.
  /// A coordinate has an error of at most 2^-53 max(|x|, 2^-1022) as a double; a normal's
  /// coordinate one of 2^-53, relatively, besides its own error bound; the sum of D products adds D
  /// + 2 roundings of its terms.
  bool surely_inside(const double* rounded) const {
    return std::all_of(planes.begin(), planes.end(), [&](const RegionPlane<D>& plane) {
      if (plane.axis >= 0) {
        const double x = rounded[plane.axis], bound = plane.through[0][plane.axis];
        return std::isfinite(x) && (plane.toward > 0 ? x < bound : x > bound);
      }
      double sum = 0, size = 0;
      for (unsigned j = 0; j < D; ++j) {
        const double n = plane.normal[j].value.high, x = rounded[j], a = plane.through[0][j];
        sum += n * x - n * a;
        size += (std::abs(n) + 0x1p50 * plane.normal[j].error) *
                (std::max(std::abs(x), 0x1p-1022) + std::abs(a));
      }
      return sum < -(size * 0x1p-48 + 0x1p-1000);
    });
  }
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
