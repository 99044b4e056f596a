// In-sphere and power tests in doubles for the certificates of triangulations.
#pragma once

#include <algorithm>
#include <cmath>

#include "exact/determinants/minors.hpp"
#include "exact/orientation/orientation.hpp"

namespace cullhull::internal::certify {

/// The sign of a determinant of rows [differences from p, lift], with an error bound from its
/// permanent; false if doubles do not decide it.
template <unsigned K>
inline bool side_filtered(unsigned width, bool weighted, const double* const* c, const double* p,
                          Sign& sign) {
  double m[K + 1][K + 1], magnitudes[K + 1][K + 1];
  double largest = 0;
  for (unsigned i = 0; i <= K; ++i) {
    double lift = 0;
    for (unsigned j = 0; j < width; ++j) {
      const double v = c[i][j] - p[j];
      if (j < K) m[i][j] = v;
      largest = std::max(largest, std::abs(v));
      lift += v * v;
    }
    double magnitude = lift;
    if (weighted) {
      const double w = c[i][width] - p[width];
      largest = std::max(largest, std::abs(w));
      lift -= w;
      magnitude += std::abs(w);
    }
    m[i][K] = lift;
    for (unsigned j = 0; j < K; ++j) magnitudes[i][j] = std::abs(m[i][j]);
    magnitudes[i][K] = magnitude;
  }
  if (!(largest >= 0x1p-60 && largest <= 0x1p60)) return false;
  double det[2U << K], unused[2U << K], perm[2U << K];
  expand_minors<K + 1, false>(m, K + 1, det, static_cast<double*>(nullptr));
  expand_minors<K + 1, true>(magnitudes, K + 1, unused, perm);
  const double roundings = minor_roundings(K + 1) + 2 * width + 8;
  const double bound = roundings * unit_roundoff * perm[(2U << K) - 1] + 0x1p-400;
  const double value = det[(2U << K) - 1];
  if (std::abs(value) <= bound) return false;
  // Seen from p: (-1)^(k + 1) for reordering rows c_i - p so that p - c_0 is the last.
  const bool positive = (value > 0) == (K % 2 == 1);
  sign = positive ? Sign::positive : Sign::negative;
  return true;
}

}  // namespace cullhull::internal::certify
