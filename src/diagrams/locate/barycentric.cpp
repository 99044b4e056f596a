#include "diagrams/locate/barycentric.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "exact/determinants/minors.hpp"
#include "exact/insphere/lift_filter.hpp"
#include "exact/numbers/double_double.hpp"
#include "exact/numbers/exact_numbers.hpp"
#include "exact/orientation/orientation.hpp"
#include "parallel/dispatch.hpp"

namespace cullhull::internal::inline diagrams {
namespace {

/// The determinants of the rows p_i - q but one by double-doubles, whose operations err by 2^-102
/// relatively: each is within `bound`, and their sum, the cell's own determinant, within (k + 1)
/// times that and some roundings. False where that does not prove the result.
template <unsigned K>
bool by_double_doubles(const double* const* p, const double* q, double* out) {
  DoubleDouble m[K + 1][K];
  double product = 1;
  for (unsigned j = 0; j < K; ++j) {
    double largest = 0;
    for (unsigned i = 0; i <= K; ++i) {
      m[i][j] = DoubleDouble::sum(p[i][j], -q[j]);
      largest = std::max(largest, std::abs(m[i][j].high));
    }
    // Then nothing overflows, and what underflows adds up to less than 2^-300.
    if (!(largest >= 0x1p-100 && largest <= 0x1p100)) return false;
    product *= largest;
  }
  const double bound = (minor_roundings(K) + 4) * 0x1p-101 * factorial(K) * product + 0x1p-300;
  DoubleDouble part[K + 1], whole;
  double sizes = 0;
  for (unsigned i = 0; i <= K; ++i) {
    DoubleDouble rows[K][K], det[1U << K];
    for (unsigned r = 0, to = 0; r <= K; ++r)
      if (r != i) std::copy_n(m[r], K, rows[to++]);
    expand_minors<K, false>(rows, K, det, static_cast<DoubleDouble*>(nullptr));
    part[i] = i % 2 == 0 ? det[(1U << K) - 1] : -det[(1U << K) - 1];
    whole = whole + part[i];
    sizes += std::abs(part[i].high);
  }
  const double doubt = (K + 1) * bound + (K + 1) * 0x1p-101 * sizes;
  if (!(doubt < 0x1p-55 * std::abs(whole.high))) return false;
  for (unsigned i = 0; i <= K; ++i) {
    if (std::abs(part[i].high) > bound) {
      out[i] = (part[i] / whole).value();
      continue;
    }
    const double* corners[K + 1];
    for (unsigned r = 0; r <= K; ++r) corners[r] = r == i ? q : p[r];
    if (orientation(K, corners) != Sign::zero) return false;
    out[i] = 0;
  }
  return true;
}

void by_rationals(unsigned k, const double* const* p, const double* q, double* out) {
  RationalRows m(k, std::vector<mpq_class>(k + 1));
  for (unsigned j = 0; j < k; ++j) {
    for (unsigned i = 0; i < k; ++i) m[j][i] = mpq_class(p[i + 1][j]) - mpq_class(p[0][j]);
    m[j][k] = mpq_class(q[j]) - mpq_class(p[0][j]);
  }
  if (!solve(m)) {
    std::fill_n(out, k + 1, NAN);
    return;
  }
  mpq_class first = 1;
  for (unsigned i = 0; i < k; ++i) {
    first -= m[i][k];
    out[i + 1] = nearest_double(m[i][k]);
  }
  out[0] = nearest_double(first);
}

}  // namespace

void barycentric(unsigned k, const double* const* p, const double* q, double* out) {
  with_dimension<1, 6, 0>(k, [&](auto known) {
    if constexpr (known() != 0) {
      if (by_double_doubles<known()>(p, q, out)) return;
    }
    by_rationals(k, p, q, out);
  });
}

}  // namespace cullhull::internal::inline diagrams
