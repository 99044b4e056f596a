// The arithmetic of the PseudoHull that every executor shares: facets, their error bounds, the
// addresses of the facet stream. Plain functions over fixed arrays that compile for a device, too.
// docs/exactness.md, "PseudoHull", derives the bounds.
#pragma once

#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

#include "exact/determinants/minors.hpp"
#include "parallel/host_device.hpp"

namespace cullhull::internal {

/// A facet of the pseudo-hull: its vertices as rows of the subset.
template <unsigned D>
struct PseudoFacet {
  std::uint32_t vertex[D];
};

/// The plane of a facet. For any point x of the subset, in its frame,
///   distance(normal, base, x) > error   proves that x is strictly outside of the facet,
///   distance(normal, base, x) < -error  proves that it is strictly on the inner side,
/// where base is the first vertex given to make_plane. A plane that is not certain has normal 0 and
/// an infinite error and proves nothing.
template <unsigned D>
struct PseudoPlane {
  double normal[D];  ///< of length 1, up to rounding
  double error;
};

/// The planes of the D facets that replace one, with the apex as their common base: the data for
/// reassigning a point of its exterior set, contiguous in memory (3D: 128 bytes).
template <unsigned D>
struct alignas(16) PseudoFan {
  double apex[D];
  PseudoPlane<D> plane[D];
};

// Example: D = 3 and K = 4 facets, j = 1: the new ones are at 1, 4 + 2 = 6 and 7. All 12 addresses
// 0 .. 11 are used once, so threads write without asking one another.

/// Returns the address of the i-th of the D facets that replace facet j of K: the first replaces it
/// in place, the others are stored after the K facets. With k = K - 1, the address of the last
/// facet, and D = 3 these are the paper's j, k + 2 j + 1, k + 2 j + 2.
template <unsigned D>
CULLHULL_HD constexpr std::uint32_t child_address(std::uint32_t facets, std::uint32_t j,
                                                  unsigned i) {
  return i == 0 ? j : facets + j * (D - 1) + (i - 1);
}

/// Returns normal . (x - base), each operation rounded once.
template <unsigned D>
CULLHULL_HD double pseudo_distance(const double* normal, const double* base, const double* x) {
  double sum = normal[0] * (x[0] - base[0]);
  for (unsigned k = 1; k < D; ++k) sum += normal[k] * (x[k] - base[k]);
  return sum;
}

/// Bounds the number of roundings along any path of expand_minors over `rows` rows of differences.
CULLHULL_HD constexpr double minor_path(unsigned rows) {
  return static_cast<double>(rows + (rows - 1) + rows * (rows - 1) / 2);
}

template <unsigned D>
CULLHULL_HD void set_uncertain(PseudoPlane<D>& plane) {
  for (unsigned k = 0; k < D; ++k) plane.normal[k] = 0;
  plane.error = std::numeric_limits<double>::infinity();
}

// The bound (docs/exactness.md, P2 and P3). The cofactors of D - 1 rows of differences are off by
// e_j = (N + 2) u perm_j + 2^-1000, N = minor_path(D - 1). s = fl(1 / fl(sqrt(Sum N_j^2))) scales
// them to length 1; it is below 2^451, as planes with a square of 2^-900 or less are not used. For
// a point x of the subset, with T = Sum e_j and S the 1-norm of the scaled normal, the computed
// distance is off by at most s T + (D + 2) u (1 + 2^-40) S + 2^-540: the cofactors' errors (|y_j|
// <= 1), the rounding of scaled normal and of the difference y, and D roundings of the dot product.
// Stored is 1.0625 (s T + (D + 3) u S) + 2^-400, which also covers the roundings of the bound.
//
// Example, 3D: a triangle with edges of 0.1 has cofactors of 0.01 and permanents of about 0.02: T =
// 3 * 6 u * 0.02 = 4e-17, as minor_path(2) = 4. s = 58, s T = 2.3e-15, and (D + 3) u S = 6 u * 1.7
// = 1.1e-15: points farther than about 4e-15 of the extent from the plane have a proved side.

/// Computes the plane through the D points corner[0 .. D), outward if `inner` is on the inner side.
/// Returns false, and an uncertain plane, if rounding could have reversed it.
template <unsigned D>
CULLHULL_HD bool make_plane(const double* const* corner, const double* inner,
                            PseudoPlane<D>& plane) {
  double rows[D][D], minor[1U << D], permanent[1U << D];
  for (unsigned i = 1; i < D; ++i)
    for (unsigned k = 0; k < D; ++k) rows[i - 1][k] = corner[i][k] - corner[0][k];
  expand_minors<D, true>(rows, D - 1, minor, permanent);

  constexpr unsigned full = (1U << D) - 1;
  constexpr double relative = (minor_path(D - 1) + 2) * unit_roundoff;
  double square = 0, doubt = 0;
  for (unsigned k = 0; k < D; ++k) {
    const double cofactor = minor[full ^ (1U << k)];
    plane.normal[k] = k % 2 != 0 ? -cofactor : cofactor;
    square += cofactor * cofactor;
    doubt += relative * permanent[full ^ (1U << k)] + 0x1p-1000;
  }
  if (!(square > 0x1p-900)) {
    set_uncertain(plane);
    return false;
  }
  const double scale = 1 / std::sqrt(square);
  double sum = 0;
  for (unsigned k = 0; k < D; ++k) {
    plane.normal[k] *= scale;
    sum += std::fabs(plane.normal[k]);
  }
  plane.error = 1.0625 * (scale * doubt + (D + 3) * unit_roundoff * sum) + 0x1p-400;

  const double side = pseudo_distance<D>(plane.normal, corner[0], inner);
  if (side > plane.error) {
    for (unsigned k = 0; k < D; ++k) plane.normal[k] = -plane.normal[k];
    return true;
  }
  if (side < -plane.error) return true;
  set_uncertain(plane);
  return false;
}

/// The position of a point relative to some facets.
struct Place {
  /// The nearest of the facets that the point is outside of (the first on ties), or one of the two
  /// values below.
  std::uint32_t facet;
  double distance;
};
inline constexpr std::uint32_t place_inside = 0xFFFFFFFF;     ///< strictly inside all: culled
inline constexpr std::uint32_t place_uncertain = 0xFFFFFFFE;  ///< neither inside nor outside is
                                                              ///< proved: it survives

/// Finds a point's Place; facets are offered one after another.
struct PlaceSearch {
  std::uint64_t facet = place_uncertain;
  std::uint64_t distance = std::bit_cast<std::uint64_t>(std::numeric_limits<double>::infinity());
  std::uint64_t inside = 1;

  // Masks instead of branches: a point's position cannot be predicted, and compilers turned other
  // forms into branches, a quarter of the filter's time. A NaN is neither outside nor inside.
  CULLHULL_HD void offer(std::uint32_t candidate, double at, double error) {
    const bool nearer = (at > error) & (at < std::bit_cast<double>(distance));
    const std::uint64_t mask = ~(static_cast<std::uint64_t>(nearer) - 1);
    facet ^= (facet ^ candidate) & mask;
    distance ^= (distance ^ std::bit_cast<std::uint64_t>(at)) & mask;
    inside &= static_cast<std::uint64_t>(at < -error);
  }
  // A point inside is outside of no facet: `facet` is then place_uncertain, one less than
  // place_inside.
  CULLHULL_HD Place result() const {
    return {static_cast<std::uint32_t>(facet + inside), std::bit_cast<double>(distance)};
  }
};

}  // namespace cullhull::internal
