#include "exact/insphere/eliminated_sign.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "exact/determinants/minors.hpp"
#include "parallel/dispatch.hpp"

namespace cullhull::internal {
namespace {

// N: the size if known at compile time, else 0.

/// The largest size with a proof: bounds are sums of non-negative terms, each with fewer than 4 (n
/// + 2)^2 factors 1 + u.
constexpr unsigned largest_size = 4096;
/// Column maxima are in this range before scaling; underflow, then or later, adds less than
/// entry_tiny to an entry, as long as no row of U adds up to more than largest_row.
constexpr double least_column = 0x1p-900, most_column = 0x1p900;
constexpr double largest_row = 0x1p60, entry_tiny = 0x1p-140;

/// Returns the largest power of two that is at most the normal number v > 0.
double power_below(double v) {
  return std::bit_cast<double>(std::bit_cast<std::uint64_t>(v) & 0x7ff0000000000000U);
}

/// Scales each column by a power of two so that its largest entry is in [0.5, 1).
template <unsigned N>
bool scale_columns(unsigned size, double* m, double* doubt) {
  const unsigned n = N != 0 ? N : size;
  for (unsigned j = 0; j < n; ++j) {
    double largest = 0;
    for (unsigned i = 0; i < n; ++i) largest = std::max(largest, std::abs(m[i * n + j]));
    if (j + 1 == n)
      for (unsigned i = 0; i < n; ++i) largest = std::max(largest, doubt[i]);
    if (!(largest >= least_column && largest <= most_column)) return false;
    const double scale = 0.5 / power_below(largest);
    for (unsigned i = 0; i < n; ++i) m[i * n + j] *= scale;
    if (j + 1 == n)
      for (unsigned i = 0; i < n; ++i) doubt[i] *= scale;
  }
  return true;
}

/// Factors m = L U with row exchanges, so that no entry of L exceeds 1 in magnitude. Returns the
/// sign of the product of the pivots and of the exchanges; zero if a pivot is zero or NaN.
template <unsigned N>
Sign eliminate(unsigned size, double* m, double* doubt) {
  const unsigned n = N != 0 ? N : size;
  bool negative = false;
  for (unsigned r = 0; r < n; ++r) {
    unsigned best = r;
    for (unsigned i = r + 1; i < n; ++i)
      if (std::abs(m[i * n + r]) > std::abs(m[best * n + r])) best = i;
    double* top = m + std::size_t{r} * n;
    if (best != r) {
      std::swap_ranges(top, top + n, m + std::size_t{best} * n);
      std::swap(doubt[r], doubt[best]);
      negative = !negative;
    }
    const double pivot = top[r];
    if (!(std::abs(pivot) > 0)) return Sign::zero;
    if (pivot < 0) negative = !negative;
    for (unsigned i = r + 1; i < n; ++i) {
      double* row = m + std::size_t{i} * n;
      const double factor = row[r] /= pivot;
      for (unsigned j = r + 1; j < n; ++j) row[j] -= factor * top[j];
    }
  }
  return negative ? Sign::negative : Sign::positive;
}

// The proof. With A = L U - F, A = L U (I - (L U)^-1 F). If every row sum of |(L U)^-1 F| is below
// 1, I - s (L U)^-1 F has no kernel for 0 <= s <= 1, so its determinant keeps the sign that it has
// at s = 0, where it is 1: det A has the sign of det(L U). F is what rounding did, |F| 1 <=
// gamma_(n+1) |L||U| 1 + doubt + underflow, and |(L U)^-1| is bounded by the inverses of the
// comparison matrices: of a triangular T the matrix with |t_ii| on the diagonal and -|t_ij| beside
// it has an inverse without negative entries that is at least |T^-1|.
//
// Example: A = [1 1; 1 1 + 1e-10] gives U = [1 1; 0 1e-10], |L||U| 1 is about (2, 2), F 1 about
// (7e-16, 7e-16), and the comparison matrices give (1.4e-5, 1.4e-5): below 1/2, so the sign of 1 *
// 1e-10 is certain. With 1e-15 in place of 1e-10 they give 1.4 and decide nothing. Underflow:
// within columns of 2^-900 to 2^900 an entry that lost 2^-1060 lost 2^-159 of its column; rows of
// |U| stay below 2^60, so quotients and products that underflow add less than n 2^-1010: 2^-140
// (entry_tiny) covers both.

/// Whether |(L U)^-1| |L U - A| 1 < 1 in all rows, 1 being the vector of ones. `x`: the doubts of
/// the last column, overwritten.
template <unsigned N>
bool regular(unsigned size, const double* m, double* x) {
  const unsigned n = N != 0 ? N : size;
  const double gamma = (n + 2) * unit_roundoff;
  thread_local std::vector<double> sums;  // |U| 1
  sums.resize(n);
  for (unsigned i = 0; i < n; ++i) {
    const double* row = m + std::size_t{i} * n;
    double own = 0;
    for (unsigned j = i; j < n; ++j) own += std::abs(row[j]);
    if (!(own < largest_row)) return false;  // NaN too
    sums[i] = own;
    double all = own, solved = 0;
    for (unsigned j = 0; j < i; ++j) {
      const double factor = std::abs(row[j]);
      all += factor * sums[j];
      solved += factor * x[j];
    }
    x[i] += gamma * all + entry_tiny + solved;
  }
  for (unsigned i = n; i-- > 0;) {
    const double* row = m + std::size_t{i} * n;
    double sum = x[i];
    for (unsigned j = i + 1; j < n; ++j) sum += std::abs(row[j]) * x[j];
    x[i] = sum / std::abs(row[i]);
    if (!(x[i] < 0.5)) return false;  // NaN too
  }
  return true;
}

}  // namespace

bool eliminated_sign(unsigned n, double* m, double* doubt, Sign& sign) {
  if (plane_only || n == 0 || n > largest_size) return false;
  return with_dimension<7, 10, 0>(n, [&](auto size) {
    if (!scale_columns<size()>(n, m, doubt)) return false;
    sign = eliminate<size()>(n, m, doubt);
    return sign != Sign::zero && regular<size()>(n, m, doubt);
  });
}

}  // namespace cullhull::internal
