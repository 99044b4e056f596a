// Exact distances in rational numbers, to check what is said of distances in doubles.
#pragma once

#include <gmpxx.h>

#include <cstdint>
#include <span>
#include <vector>

#include "exact/numbers/rationals.hpp"

namespace cullhull::testing_support {

/// (a - o) . (b - o), exactly.
inline mpq_class relative_product(const double* a, const double* b, const double* o, unsigned d) {
  mpq_class sum;
  for (unsigned j = 0; j < d; ++j) {
    const mpq_class from(o[j]);
    sum += (mpq_class(a[j]) - from) * (mpq_class(b[j]) - from);
  }
  return sum;
}

/// Whether the point of the flat of `corners` nearest to `o` is a combination of them without
/// negative weights and at most `distance` away. With G the products of the corners relative to o,
/// that point's weights w and squared distance s solve G w = s (1, ..., 1), sum w = 1.
inline bool near_in_flat(const std::vector<const double*>& corners, const double* o, unsigned d,
                         double distance) {
  const std::size_t m = corners.size();
  internal::RationalRows system(m + 1, std::vector<mpq_class>(m + 2));
  for (std::size_t i = 0; i < m; ++i) {
    for (std::size_t j = 0; j < m; ++j)
      system[i][j] = relative_product(corners[i], corners[j], o, d);
    system[i][m] = -1;
    system[m][i] = 1;
  }
  system[m][m + 1] = 1;
  if (!internal::solves_without_negatives(system)) return false;
  return system[m][m + 1] / system[m][m] <= mpq_class(distance) * mpq_class(distance);
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
  mpq_class value(plane[d]), length;
  for (unsigned j = 0; j < d; ++j) {
    const mpq_class n(plane[j]);
    value += n * mpq_class(x[j]);
    length += n * n;
  }
  return value * value <= mpq_class(distance) * mpq_class(distance) * length;
}

}  // namespace cullhull::testing_support
