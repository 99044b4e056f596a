#include "exact/planes/oriented_plane.hpp"

#include <algorithm>

namespace cullhull::internal::inline exact {

void OrientedPlane::set(unsigned d, const double* const* p) {
  d_ = d;
  p_.assign(p, p + d);
  exact_set_ = false;
  refined_ = Refined::untried;
  eliminated_ = plane_.set(d, p_.data());
}

Sign OrientedPlane::side(const double* x, Rung* rung) {
  if (rung != nullptr) *rung = Rung::filter;
  bool known = false;
  if (eliminated_) {
    const Sign sign = plane_.side(x, known);
    if (known) return sign;
  }
  if (surely_zero(x)) return Sign::zero;
  if (eliminated_ && refined_ == Refined::untried)
    refined_ = plane_.refine() ? Refined::yes : Refined::no;
  if (refined_ == Refined::yes) {
    const Sign sign = plane_.refined_side(x, known);
    if (known) return sign;
  }
  if (rung != nullptr) *rung = Rung::exact;
  return exact().side(x);
}

bool OrientedPlane::proper() { return eliminated_ || !exact().degenerate(); }

/// Whether all points lie on a plane across an axis, or two of them are equal.
bool OrientedPlane::surely_zero(const double* x) const {
  for (unsigned j = 0; j < d_; ++j)
    if (std::all_of(p_.begin(), p_.end(), [&](const double* q) { return q[j] == x[j]; }))
      return true;
  return std::any_of(p_.begin(), p_.end(),
                     [&](const double* q) { return std::equal(q, q + d_, x); });
}

ExactPlane& OrientedPlane::exact() {
  if (!exact_set_) exact_.set(d_, p_.data());
  exact_set_ = true;
  return exact_;
}

}  // namespace cullhull::internal::inline exact
