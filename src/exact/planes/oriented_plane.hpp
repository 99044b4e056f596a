// The ladder for one hyperplane and many points, in any dimension: what a rung computes for the
// plane is computed once.
#pragma once

#include <vector>

#include "exact/orientation/orientation.hpp"
#include "exact/planes/eliminated_plane.hpp"
#include "exact/planes/exact_plane.hpp"

namespace cullhull::internal::inline exact {

/// From this dimension on an elimination, O(d^3), is faster than the 2^d minors of an expansion.
inline constexpr unsigned elimination_pays = 7;

class OrientedPlane {
 public:
  /// Through p[0..d), d >= 2. The coordinates must outlive the plane, the pointers need not.
  void set(unsigned d, const double* const* p);
  /// Sign of orientation(p[0], ..., p[d-1], x), exactly; `rung`, if given, receives what decided:
  /// Rung::filter for doubles and double-doubles, Rung::exact for integers.
  Sign side(const double* x, Rung* rung = nullptr);
  /// Whether p[0..d) are affinely independent, exactly.
  bool proper();

 private:
  bool surely_zero(const double* x) const;
  ExactPlane& exact();

  unsigned d_ = 0;
  std::vector<const double*> p_;
  bool eliminated_ = false, exact_set_ = false;
  enum class Refined : unsigned char { untried, yes, no } refined_ = Refined::untried;
  EliminatedPlane plane_;
  ExactPlane exact_;
};

}  // namespace cullhull::internal::inline exact
