// The arithmetic of star-shaped surfaces of triangles: facets with their neighbours, signs of
// determinants with their error bounds. Plain functions that compile for a device, too.
#pragma once

#include <cmath>
#include <cstdint>

#include "exact/determinants/minors.hpp"
#include "filter/pseudo_hull/pseudo_hull_math.hpp"
#include "parallel/host_device.hpp"

namespace cullhull::internal {

/// A side of a facet: that opposite to its vertex `corner()`.
struct StarSide {
  std::uint32_t code;
  CULLHULL_HD std::uint32_t facet() const { return code >> 2; }
  CULLHULL_HD unsigned corner() const { return code & 3U; }
};
CULLHULL_HD_INLINE StarSide side_of_facet(std::uint32_t facet, unsigned corner) {
  return {facet << 2 | corner};
}

/// A triangle of a surface that is star-shaped around a centre: det [a - c; b - c; d - c] > 0 for
/// its vertices a, b, d and the centre c. across[k] is the neighbour's side that it shares opposite
/// to vertex k. A triangle that a flip removed has its first vertex twice.
struct alignas(8) StarFacet {
  std::uint32_t vertex[3];
  StarSide across[3];

  CULLHULL_HD bool live() const { return vertex[0] != vertex[1]; }
};

/// The corner after k, and the one after that.
CULLHULL_HD constexpr unsigned next_corner(unsigned k) { return k == 2 ? 0 : k + 1; }
CULLHULL_HD constexpr unsigned last_corner(unsigned k) { return k == 0 ? 2 : k - 1; }

// Example: o = 0, a = (1, 0, 0), b = (0, 1, 0), c = (0, 0, 1e-14): the determinant and the
// permanent are 1e-14, the bound 13 u of it: certain. What counts is not how small the determinant
// is but how much of the permanent cancelled.

/// The sign (1 or -1) of det [a - o; b - o; c - o] where its error bound proves it, else 0. The
/// same filter as Orientation3D's.
CULLHULL_HD_INLINE int star_sign(const double* o, const double* a, const double* b,
                                 const double* c) {
  double rows[3][3], minor[8], permanent[8];
  for (unsigned k = 0; k < 3; ++k) {
    rows[0][k] = a[k] - o[k];
    rows[1][k] = b[k] - o[k];
    rows[2][k] = c[k] - o[k];
  }
  expand_minors<3, true>(rows, 3, minor, permanent);
  const double bound = (minor_path(3) + 5) * unit_roundoff * permanent[7] + 0x1p-1000;
  return minor[7] > bound ? 1 : minor[7] < -bound ? -1 : 0;
}

}  // namespace cullhull::internal
