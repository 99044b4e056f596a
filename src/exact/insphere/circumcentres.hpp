// Circumcentres and radii by double-doubles, a cell in each lane of a vector.
#pragma once

#include <cstddef>

namespace cullhull::internal {

/// The number of cells per call.
inline constexpr std::size_t centres_block = 8;

/// Whether these functions take cells in k dimensions.
constexpr bool has_centres_block(unsigned k) { return k >= 2 && k <= 4; }

/// Computes circumcentre() for centres_block full-dimensional cells without weights,
/// has_centres_block(k). corners[(i k + j) centres_block + cell]: coordinate j of corner i.
/// centres[j centres_block + cell] receives coordinate j of the centre, or NaN if double-doubles do
/// not prove how it rounds.
void circumcentres_double_double(unsigned k, const double* corners, double* centres);

/// Computes radius_above() for the same cells; NaN if double-doubles do not prove which double it
/// is, as where the radius is one.
void circumradii_double_double(unsigned k, const double* corners, double* radii);

}  // namespace cullhull::internal
