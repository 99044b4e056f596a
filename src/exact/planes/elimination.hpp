// Gaussian elimination with complete pivoting, in doubles.
//
// Why complete pivoting: with the largest remaining entry as the pivot no entry of L exceeds 1, no
// entry of U its row's pivot, and elements hardly grow (less than 2^4 in all cases met up to tens
// of dimensions), so the bound gamma |L||U| stays near u times the matrix itself.
#pragma once

#include <cstddef>

namespace cullhull::internal {

/// The distance of rows in a matrix, in doubles: a vector of this many doubles that begins in any
/// column does not reach the next row.
inline constexpr std::size_t elimination_lanes = 8;
constexpr std::size_t elimination_stride(std::size_t columns) {
  return columns + elimination_lanes - 1;
}

/// Factors a matrix of `rows` < `columns` rows in place into L, below the diagonal, and U, on and
/// above it, with rows and columns in pivot order. The stride is elimination_stride(columns);
/// entries beyond `columns` must be 0. row[i], column[j]: the original index of the row or column
/// now at i or j. Of equal pivots the first is chosen, by rows and then by columns. No product is
/// fused with a difference, so that all machines compute the same bits. Returns the number of
/// pivots found: less than `rows` if the next one is not above `least` and below `most`. `odd`: the
/// parity of all exchanges. Time: O(rows^2 columns).
unsigned eliminate(double* matrix, unsigned rows, unsigned columns, unsigned* row, unsigned* column,
                   double least, double most, bool& odd);

}  // namespace cullhull::internal
