// The arithmetic of one facet, in doubles.
#pragma once

#include <algorithm>
#include <cmath>

#include "exact/determinants/cofactors.hpp"

namespace cullhull::internal::inline result {

inline double root(double v) { return std::sqrt(v); }
inline double absolute(double v) { return std::fabs(v); }
inline double greater_of(double a, double b) { return std::max(a, b); }

#define CULLHULL_MATH inline
#include "result/facets/facet_math-inl.hpp"
#undef CULLHULL_MATH

}  // namespace cullhull::internal::inline result
