// Barycentric coordinates with a bound. docs/exactness.md, "Points in cells".
#pragma once

namespace cullhull::internal::inline diagrams {

/// Of q in the simplex of k + 1 points of R^k, k >= 0, affinely independent: each within 2^-50
/// max(1, |itself|) of exact, exact zeros zero.
void barycentric(unsigned k, const double* const* p, const double* q, double* out);

}  // namespace cullhull::internal::inline diagrams
