#include "diagrams/voronoi/clip_corners.hpp"

#include <algorithm>
#include <cmath>

#include "exact/numbers/rationals.hpp"

namespace cullhull::internal {
namespace {

template <class Real>
Sign sign_of_real(const Real& v);
template <>
Sign sign_of_real(const mpq_class& v) {
  return static_cast<Sign>(sgn(v));
}
template <>
Sign sign_of_real(const BoundedDoubleDouble& v) {
  return certain_sign(v);
}

/// The height of x above the plane, times the length of its normal.
template <unsigned D, class Real>
Real height(const Halfspace<D, Real>& h, const std::array<Real, std::size_t{D}>& x) {
  Real sum = -h.offset;
  for (unsigned j = 0; j < D; ++j) sum = sum + h.normal[j] * x[j];
  return sum;
}

}  // namespace

template <unsigned D>
void CellCorners<D>::start(const double* p, bool weighted, bool furthest) {
  p_ = p;
  weighted_ = weighted;
  furthest_ = furthest;
  planes_.clear();
  corners_.clear();
}

template <unsigned D>
template <class Real>
Halfspace<D, Real> CellCorners<D>::halfspace_of(const Plane& plane) const {
  if (plane.site != nullptr) {
    Halfspace<D, Real> h = bisector<D, Real>(p_, plane.site, weighted_);
    if (furthest_) {
      for (Real& n : h.normal) n = -n;
      h.offset = -h.offset;
    }
    return h;
  }
  Halfspace<D, Real> h;
  const RegionPlane<D>& b = *plane.boundary;
  if constexpr (std::is_same_v<Real, BoundedDoubleDouble>)
    h.normal = b.normal;
  else
    h.normal = normal_of<D, Real>(b);
  if (b.axis >= 0) {
    const auto j = static_cast<unsigned>(b.axis);
    h.offset = h.normal[j] * exact_difference<Real>(b.through[0][j], p_[j]);
    return h;
  }
  h.offset = Real(0.0);
  for (unsigned j = 0; j < D; ++j)
    h.offset = h.offset + h.normal[j] * exact_difference<Real>(b.through[0][j], p_[j]);
  return h;
}

template <unsigned D>
std::uint32_t CellCorners<D>::add_bisector(const double* q, std::uint32_t label) {
  planes_.push_back({q, nullptr, label, {}, {}});
  planes_.back().near = halfspace_of<BoundedDoubleDouble>(planes_.back());
  return static_cast<std::uint32_t>(planes_.size() - 1);
}
template <unsigned D>
std::uint32_t CellCorners<D>::add_boundary(const RegionPlane<D>& plane, std::uint32_t label) {
  planes_.push_back({nullptr, &plane, label, {}, {}});
  planes_.back().near = halfspace_of<BoundedDoubleDouble>(planes_.back());
  return static_cast<std::uint32_t>(planes_.size() - 1);
}
template <unsigned D>
std::uint32_t CellCorners<D>::add_given(const double* x) {
  Corner corner{x, {}, {}, {}};
  for (unsigned j = 0; j < D; ++j) corner.at[j] = BoundedDoubleDouble::difference(x[j], p_[j]);
  corners_.push_back(std::move(corner));
  return corner_count() - 1;
}
template <unsigned D>
std::uint32_t CellCorners<D>::add_meeting(const std::array<std::uint32_t, D>& planes) {
  std::array<const Halfspace<D, BoundedDoubleDouble>*, D> h;
  for (unsigned j = 0; j < D; ++j) h[j] = &planes_[planes[j]].near;
  corners_.push_back({nullptr, planes, meeting<BoundedDoubleDouble>(h), {}});
  return corner_count() - 1;
}

template <unsigned D>
const Halfspace<D, mpq_class>& CellCorners<D>::exact_halfspace(std::uint32_t plane) {
  Plane& p = planes_[plane];
  if (!p.exact) p.exact = halfspace_of<mpq_class>(p);
  return *p.exact;
}

template <unsigned D>
const ExactPoint<D>& CellCorners<D>::exact(std::uint32_t corner) {
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

template <unsigned D>
Sign CellCorners<D>::side(std::uint32_t plane, std::uint32_t corner) {
  const Corner& c = corners_[corner];
  if (c.given == nullptr && std::find(c.planes.begin(), c.planes.end(), plane) != c.planes.end())
    return Sign::zero;
  const Sign sign = sign_of_real(height<D>(planes_[plane].near, c.at));
  if (sign != Sign::zero) return sign;
  return sign_of_real(height<D>(exact_halfspace(plane), exact(corner)));
}

template <unsigned D>
void CellCorners<D>::round(std::uint32_t corner, double* out) {
  const Corner& c = corners_[corner];
  for (unsigned j = 0; j < D; ++j) {
    if (c.given != nullptr)
      out[j] = c.given[j];
    else if (!rounds_alike(BoundedDoubleDouble(p_[j]) + c.at[j], out[j]))
      out[j] = nearest_double(mpq_class(p_[j]) + exact(corner)[j]);
    if (out[j] == 0) out[j] = 0;  // -0 becomes 0
  }
}

template <unsigned D>
bool CellCorners<D>::equal(std::uint32_t a, std::uint32_t b) {
  for (unsigned j = 0; j < D; ++j)
    if (certain_sign(at(a)[j] - at(b)[j]) != Sign::zero) return false;
  return a == b || exact(a) == exact(b);
}

template class CellCorners<1>;
template class CellCorners<2>;
template class CellCorners<3>;

}  // namespace cullhull::internal
