// Exact distances in rational numbers, to check what is said of distances in doubles.
#pragma once

#include <gmp.h>

#include <cstdint>
#include <span>
#include <vector>

#include "exact/numbers/rational.hpp"

namespace cullhull::testing_support {

using internal::Rational;
using internal::RationalMatrix;

/// out = (a - o) . (b - o), exactly.
inline void relative_product(mpq_ptr out, const double* a, const double* b, const double* o,
                             unsigned d) {
  Rational x, y, z;
  mpq_set_ui(out, 0, 1);
  for (unsigned j = 0; j < d; ++j) {
    mpq_set_d(x.value, a[j]);
    mpq_set_d(y.value, b[j]);
    mpq_set_d(z.value, o[j]);
    mpq_sub(x.value, x.value, z.value);
    mpq_sub(y.value, y.value, z.value);
    mpq_mul(x.value, x.value, y.value);
    mpq_add(out, out, x.value);
  }
}

/// Whether the point of the flat of `corners` nearest to `o` is a combination of them without
/// negative weights and at most `distance` away. With G the products of the corners relative to o,
/// that point's weights w and squared distance s solve G w = s (1, ..., 1), sum w = 1.
inline bool near_in_flat(const std::vector<const double*>& corners, const double* o, unsigned d,
                         double distance) {
  const std::size_t m = corners.size();
  RationalMatrix system(m + 1, m + 2);
  for (std::size_t i = 0; i < m; ++i) {
    for (std::size_t j = 0; j < m; ++j)
      relative_product(system.at(i, j), corners[i], corners[j], o, d);
    mpq_set_si(system.at(i, m), -1, 1);
    mpq_set_ui(system.at(m, i), 1, 1);
  }
  mpq_set_ui(system.at(m, m + 1), 1, 1);
  if (!system.solves_without_negatives()) return false;
  Rational square, allowed;
  mpq_div(square.value, system.at(m, m + 1), system.at(m, m));
  mpq_set_d(allowed.value, distance);
  mpq_mul(allowed.value, allowed.value, allowed.value);
  return mpq_cmp(square.value, allowed.value) <= 0;
}

/// Whether a simplex comes within `distance` of `o`, exactly: the nearest point of it is the
/// nearest of the flat of some of its corners.
inline bool near_simplex(std::span<const double* const> simplex, const double* o, unsigned d,
                         double distance) {
  for (unsigned subset = (1U << simplex.size()) - 1; subset > 0; --subset) {
    std::vector<const double*> corners;
    for (std::size_t i = 0; i < simplex.size(); ++i)
      if (subset >> i & 1) corners.push_back(simplex[i]);
    if (near_in_flat(corners, o, d, distance)) return true;
  }
  return false;
}

/// Whether x is within `distance` of the plane of d + 1 doubles (normal of any length, offset).
inline bool near_plane(const double* plane, const double* x, unsigned d, double distance) {
  Rational value, length, a, b;
  mpq_set_d(value.value, plane[d]);
  for (unsigned j = 0; j < d; ++j) {
    mpq_set_d(a.value, plane[j]);
    mpq_set_d(b.value, x[j]);
    mpq_mul(b.value, a.value, b.value);
    mpq_add(value.value, value.value, b.value);
    mpq_mul(a.value, a.value, a.value);
    mpq_add(length.value, length.value, a.value);
  }
  mpq_mul(value.value, value.value, value.value);
  mpq_set_d(a.value, distance);
  mpq_mul(a.value, a.value, a.value);
  mpq_mul(a.value, a.value, length.value);
  return mpq_cmp(value.value, a.value) <= 0;
}

}  // namespace cullhull::testing_support
