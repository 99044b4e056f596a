#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "exact/insphere/eliminated_sign.hpp"
#include "exact/insphere/lift_filter.hpp"
#include "exact/insphere/lifted_rows.hpp"
#include "parallel/dispatch.hpp"

namespace cullhull::internal {
namespace {

template <unsigned K>
Sign double_double_side(const LiftedPoints& s, const double* const* c, const double* p) {
  DoubleDouble m[K + 1][K + 1];
  double largest[K + 1] = {};
  lifted_rows<K>(s, c, p, m, largest);
  const double value = determinant(m).high;
  const double bound = lift_bound<K>(largest, s.width, double_double_roundoff, s.tiny);
  return value > bound ? Sign::positive : value < -bound ? Sign::negative : Sign::zero;
}

// Example, 8D without weights: a lift is the sum of 8 squares of differences. Each square is off by
// 3 u of itself (the difference twice, the square), and passes up to 7 sums: (2 * 8 + 8) u = 24 u
// of the sum of the squares covers these and the two roundings of a weight. Such a doubt of 24 u is
// given to eliminated_sign() for the last column, where cancelling lifts would hide it.

/// Computes the matrix of `lift_side_exact` in doubles, and error bounds of its lifts. They count a
/// difference's error twice, a square, d - 1 sums, two errors of a weight, and those of the bound.
void lifted_matrix(const LiftedPoints& s, const double* const* c, const double* p, double* m,
                   double* doubt) {
  const unsigned k = s.base;
  for (unsigned i = 0; i <= k; ++i, m += k + 1) {
    const double* q = i < k ? c[i + 1] : p;
    double lift = 0;
    for (unsigned j = 0; j < s.width; ++j) {
      const double v = q[j] - c[0][j];
      if (j < k) m[j] = v;
      lift += v * v;
    }
    double magnitude = lift;
    if (s.weighted) {
      const double w = q[s.width] - c[0][s.width];
      lift -= w;
      magnitude += std::abs(w);
    }
    m[k] = lift;
    doubt[i] = (2 * s.width + 8) * unit_roundoff * magnitude;
  }
}

/// Returns memory for a matrix of n x n and n doubts after it.
double* room_for_matrix(unsigned n) {
  thread_local std::vector<double> numbers;
  numbers.resize(std::size_t{n} * (n + 1));
  return numbers.data();
}

}  // namespace

bool base_orientation_eliminated(unsigned k, const double* const* p, Sign& sign) {
  double *matrix = room_for_matrix(k), *doubt = matrix + std::size_t{k} * k;
  for (unsigned i = 0; i < k; ++i)
    for (unsigned j = 0; j < k; ++j) matrix[i * k + j] = p[i + 1][j] - p[0][j];
  std::fill_n(doubt, k, 0.0);
  return eliminated_sign(k, matrix, doubt, sign);
}

bool lift_side_eliminated(const LiftedPoints& s, const double* const* c, const double* p,
                          Sign& sign) {
  const unsigned n = s.base + 1;
  double *matrix = room_for_matrix(n), *doubt = matrix + std::size_t{n} * n;
  lifted_matrix(s, c, p, matrix, doubt);
  if (!eliminated_sign(n, matrix, doubt, sign)) return false;
  if (s.furthest) sign = -sign;
  return true;
}

Sign lift_side_exact(const LiftedPoints& s, const double* const* c, const double* p) {
  const Sign sign = determinant_sign(LiftedRows(s.base, s.width, s.weighted, c, p));
  return s.furthest ? -sign : sign;
}

Sign lift_side_double_double(const LiftedPoints& s, const double* const* c, const double* p) {
  constexpr unsigned most = plane_only ? 2 : 6;
  return with_dimension<2, most, 0>(s.base, [&](auto k) {
    if constexpr (k() == 0) {
      return Sign::zero;
    } else {
      const Sign sign = double_double_side<k()>(s, c, p);
      return s.furthest ? -sign : sign;
    }
  });
}

}  // namespace cullhull::internal
