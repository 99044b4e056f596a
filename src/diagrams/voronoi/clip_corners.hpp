// The halfspaces of one clipped cell and the corners in which D of their planes meet. All signs are
// exact. docs/exactness.md, "Clipped cells".
#pragma once

#include <gmpxx.h>

#include <array>
#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include "diagrams/voronoi/clip_region.hpp"
#include "exact/numbers/bounded.hpp"
#include "exact/orientation/orientation.hpp"
#include "exact/planes/halfspace.hpp"

namespace cullhull::internal {

template <unsigned D>
using ExactPoint = std::array<mpq_class, D>;
/// Coordinates as double-doubles, each with an error bound.
template <unsigned D>
using TrackedPoint = std::array<BoundedDoubleDouble, D>;

/// Planes and corners are numbered in the order in which they are added.
template <unsigned D>
class CellCorners {
 public:
  /// Starts a new cell. `p`: the row of its site, D coordinates and, if `weighted`, the weight.
  void start(const double* p, bool weighted, bool furthest);

  /// Adds the halfspace of the points that are at least as near to p as to the site with row q
  /// (with `furthest`: at least as far). `label`: that site's number. Returns the plane's number.
  std::uint32_t add_bisector(const double* q, std::uint32_t label);
  std::uint32_t add_boundary(const RegionPlane<D>& plane, std::uint32_t label);
  std::uint32_t add_given(const double* x);
  std::uint32_t add_meeting(const std::array<std::uint32_t, D>& planes);

  std::uint32_t label(std::uint32_t plane) const { return planes_[plane].label; }
  bool is_bisector(std::uint32_t plane) const { return planes_[plane].site != nullptr; }
  bool is_given(std::uint32_t corner) const { return corners_[corner].given != nullptr; }
  std::uint32_t corner_count() const { return static_cast<std::uint32_t>(corners_.size()); }

  /// The side of the plane on which the corner is; positive: outside the halfspace.
  Sign side(std::uint32_t plane, std::uint32_t corner);
  /// The corner relative to the cell's site.
  const TrackedPoint<D>& at(std::uint32_t corner) const { return corners_[corner].at; }
  const ExactPoint<D>& exact(std::uint32_t corner);
  /// Writes the corner's coordinates, each rounded to the nearest double.
  void round(std::uint32_t corner, double* out);
  bool equal(std::uint32_t a, std::uint32_t b);
  const Halfspace<D, BoundedDoubleDouble>& halfspace(std::uint32_t plane) const {
    return planes_[plane].near;
  }
  const Halfspace<D, mpq_class>& exact_halfspace(std::uint32_t plane);

 private:
  struct Plane {
    const double* site;  ///< the other site's row for a bisector, else null
    const RegionPlane<D>* boundary;
    std::uint32_t label;
    Halfspace<D, BoundedDoubleDouble> near;
    std::optional<Halfspace<D, mpq_class>> exact;
  };
  struct Corner {
    const double* given;
    std::array<std::uint32_t, D> planes;
    TrackedPoint<D> at;
    std::optional<ExactPoint<D>> exact;
  };
  template <class Real>
  Halfspace<D, Real> halfspace_of(const Plane& plane) const;

  const double* p_ = nullptr;
  bool weighted_ = false, furthest_ = false;
  std::vector<Plane> planes_;
  std::vector<Corner> corners_;
};

extern template class CellCorners<1>;
extern template class CellCorners<2>;
extern template class CellCorners<3>;

}  // namespace cullhull::internal
