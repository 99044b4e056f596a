// Circumcentres and radii by double-doubles, a cell in each lane of a vector.
#pragma once

#include <cstddef>

namespace cullhull::internal {

/// The number of cells per call.
inline constexpr std::size_t centres_block = 8;

/// Whether these functions take cells in k dimensions.
constexpr bool has_centres_block(unsigned k) { return k >= 2 && k <= 4; }

/// Computes circumcentre() for `cells` <= centres_block full-dimensional cells in 1 <= k <= 6
/// dimensions. corners[(i (k + weighted) + j) centres_block + cell]: coordinate j of corner i, or
/// its weight; all centres_block of them must be numbers. centres[j centres_block + cell] receives
/// coordinate j of the centre, or NaN if double-doubles do not prove how it rounds.
void centres_double_double(unsigned k, bool weighted, const double* corners, std::size_t cells,
                           double* centres);
/// Computes radius_above() for cells without weights; NaN if double-doubles do not prove which
/// double it is, as where the radius is one.
void radii_double_double(unsigned k, const double* corners, std::size_t cells, double* radii);

/// Both for centres_block cells without weights.
inline void circumcentres_double_double(unsigned k, const double* corners, double* centres) {
  centres_double_double(k, false, corners, centres_block, centres);
}
inline void circumradii_double_double(unsigned k, const double* corners, double* radii) {
  radii_double_double(k, corners, centres_block, radii);
}

}  // namespace cullhull::internal
