// Signs of sums of products of two differences, for comparing lengths, and for angles.
#pragma once

#include <span>

#include "exact/orientation/orientation.hpp"

namespace cullhull::internal {

/// A term: the sum over d axes of sign (a - b) (c - e).
struct DifferenceProduct {
  double sign;
  const double *a, *b, *c, *e;
};

/// A sum evaluated in doubles.
struct EstimatedSum {
  double value = 0;
  double bound = 0;   ///< bound of |value - exact sum|
  bool exact = true;  ///< nothing was rounded
};

EstimatedSum estimate_products(unsigned d, std::span<const DifferenceProduct> terms);

/// Returns the sign of the sum, exactly, for any finite doubles.
Sign sign_of_products(unsigned d, std::span<const DifferenceProduct> terms);

/// Returns the sign of |a - b|^2 - |c - e|^2.
Sign compare_lengths(unsigned d, const double* a, const double* b, const double* c,
                     const double* e);

}  // namespace cullhull::internal
