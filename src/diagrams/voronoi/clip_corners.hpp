// The halfspaces of one clipped cell and the corners in which D of their planes meet. All signs are
// exact. docs/exactness.md, "Clipped cells".
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <type_traits>
#include <utility>
#include <vector>

#include "diagrams/voronoi/clip_region.hpp"
#include "exact/numbers/bounded.hpp"
#include "exact/numbers/gmpxx.hpp"
#include "exact/numbers/rationals.hpp"
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
  void start(const double* p, bool weighted, bool furthest) {
    p_ = p;
    weighted_ = weighted;
    furthest_ = furthest;
    planes_.clear();
    corners_.clear();
  }

  /// Adds the halfspace of the points that are at least as near to p as to the site with row q
  /// (with `furthest`: at least as far). `label`: that site's number. Returns the plane's number.
  std::uint32_t add_bisector(const double* q, std::uint32_t label) {
    return add_plane(q, nullptr, label);
  }
  std::uint32_t add_boundary(const RegionPlane<D>& plane, std::uint32_t label) {
    return add_plane(nullptr, &plane, label);
  }
  std::uint32_t add_given(const double* x) {
    Corner corner{x, {}, {}, {}};
    for (unsigned j = 0; j < D; ++j) corner.at[j] = BoundedDoubleDouble::difference(x[j], p_[j]);
    return add_corner(std::move(corner));
  }
  std::uint32_t add_meeting(const std::array<std::uint32_t, D>& planes) {
    std::array<const Halfspace<D, BoundedDoubleDouble>*, D> h;
    for (unsigned j = 0; j < D; ++j) h[j] = &planes_[planes[j]].near;
    return add_corner({nullptr, planes, meeting<BoundedDoubleDouble>(h), {}});
  }

  std::uint32_t label(std::uint32_t plane) const { return planes_[plane].label; }
  bool is_bisector(std::uint32_t plane) const { return planes_[plane].site != nullptr; }
  /// The site across the plane; no_index if it is the region's.
  std::uint32_t site_across(std::uint32_t plane) const {
    return is_bisector(plane) ? label(plane) : no_index;
  }
  /// The piece of the region across the plane; no_index if there is none.
  std::uint32_t piece_across(std::uint32_t plane) const {
    return is_bisector(plane) ? no_index : label(plane);
  }
  bool is_given(std::uint32_t corner) const { return corners_[corner].given != nullptr; }

  /// The side of the plane on which the corner is; positive: outside the halfspace.
  Sign side(std::uint32_t plane, std::uint32_t corner) {
    const Corner& c = corners_[corner];
    if (c.given == nullptr && std::find(c.planes.begin(), c.planes.end(), plane) != c.planes.end())
      return Sign::zero;
    const Sign sign = certain_sign(height(planes_[plane].near, c.at));
    if (sign != Sign::zero) return sign;
    return static_cast<Sign>(sgn(height(exact_halfspace(plane), exact(corner))));
  }
  /// The corner relative to the cell's site.
  const TrackedPoint<D>& at(std::uint32_t corner) const { return corners_[corner].at; }
  const ExactPoint<D>& exact(std::uint32_t corner) {
    Corner& c = corners_[corner];
    if (c.exact) return *c.exact;
    if (c.given != nullptr) {
      ExactPoint<D> x;
      for (unsigned j = 0; j < D; ++j) x[j] = exact_difference<mpq_class>(c.given[j], p_[j]);
      c.exact = std::move(x);
    } else {
      std::array<const Halfspace<D, mpq_class>*, D> h;
      for (unsigned j = 0; j < D; ++j) h[j] = &exact_halfspace(c.planes[j]);
      c.exact = meeting<mpq_class>(h);
    }
    return *c.exact;
  }
  /// Writes the corner's coordinates, each rounded to the nearest double.
  void round(std::uint32_t corner, double* out) {
    const Corner& c = corners_[corner];
    for (unsigned j = 0; j < D; ++j) {
      if (c.given != nullptr)
        out[j] = c.given[j];
      else if (!rounds_alike(BoundedDoubleDouble(p_[j]) + c.at[j], out[j]))
        out[j] = nearest_double(mpq_class(p_[j]) + exact(corner)[j]);
      if (out[j] == 0) out[j] = 0;  // -0 becomes 0
    }
  }
  bool equal(std::uint32_t a, std::uint32_t b) {
    for (unsigned j = 0; j < D; ++j)
      if (certain_sign(at(a)[j] - at(b)[j]) != Sign::zero) return false;
    return a == b || exact(a) == exact(b);
  }
  const Halfspace<D, BoundedDoubleDouble>& halfspace(std::uint32_t plane) const {
    return planes_[plane].near;
  }
  const Halfspace<D, mpq_class>& exact_halfspace(std::uint32_t plane) {
    Plane& p = planes_[plane];
    if (!p.exact) p.exact = halfspace_of<mpq_class>(p);
    return *p.exact;
  }

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
  std::uint32_t add_plane(const double* site, const RegionPlane<D>* boundary, std::uint32_t label) {
    planes_.push_back({site, boundary, label, {}, {}});
    planes_.back().near = halfspace_of<BoundedDoubleDouble>(planes_.back());
    return static_cast<std::uint32_t>(planes_.size() - 1);
  }
  std::uint32_t add_corner(Corner corner) {
    corners_.push_back(std::move(corner));
    return static_cast<std::uint32_t>(corners_.size() - 1);
  }

  /// The height of x above the plane, times the length of its normal.
  template <class Real>
  static Real height(const Halfspace<D, Real>& h, const std::array<Real, D>& x) {
    Real sum = -h.offset;
    for (unsigned j = 0; j < D; ++j) sum = sum + h.normal[j] * x[j];
    return sum;
  }
  template <class Real>
  Halfspace<D, Real> halfspace_of(const Plane& plane) const {
    if (plane.site != nullptr) {
      Halfspace<D, Real> h = bisector<D, Real>(p_, plane.site, weighted_);
      for (unsigned j = 0; furthest_ && j < D; ++j) h.normal[j] = -h.normal[j];
      if (furthest_) h.offset = -h.offset;
      return h;
    }
    Halfspace<D, Real> h;
    const RegionPlane<D>& b = *plane.boundary;
    if constexpr (std::is_same_v<Real, BoundedDoubleDouble>)
      h.normal = b.normal;
    else
      h.normal = normal_of<D, Real>(b);
    if (b.axis >= 0) {
      h.offset = h.normal[b.axis] * exact_difference<Real>(b.through[0][b.axis], p_[b.axis]);
      return h;
    }
    h.offset = Real(0.0);
    for (unsigned j = 0; j < D; ++j)
      h.offset = h.offset + h.normal[j] * exact_difference<Real>(b.through[0][j], p_[j]);
    return h;
  }

  const double* p_ = nullptr;
  bool weighted_ = false, furthest_ = false;
  std::vector<Plane> planes_;
  std::vector<Corner> corners_;
};

}  // namespace cullhull::internal
