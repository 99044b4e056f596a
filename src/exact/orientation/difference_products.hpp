// Signs of sums of products of two differences: comparisons of lengths, and angles.
#pragma once

#include <span>

#include "exact/orientation/orientation.hpp"

namespace cullhull::internal::inline exact {

/// The sum over d axes of sign (a - b) (c - e).
struct DifferenceProduct {
  double sign;
  const double *a, *b, *c, *e;
};

/// A sum in doubles.
struct EstimatedSum {
  double value = 0;
  double bound = 0;   ///< the exact sum is within it
  bool exact = true;  ///< nothing was rounded
};

EstimatedSum estimate_products(unsigned d, std::span<const DifferenceProduct> terms);

/// Exactly. Any finite doubles.
Sign sign_of_products(unsigned d, std::span<const DifferenceProduct> terms);

/// Sign of |a - b|^2 - |c - e|^2.
Sign compare_lengths(unsigned d, const double* a, const double* b, const double* c,
                     const double* e);

}  // namespace cullhull::internal::inline exact
