// Centres of circumscribed and orthogonal spheres, correctly rounded.
#pragma once

namespace cullhull::internal {

/// Computes the point of the flat of p[0 .. k], affinely independent in R^d, k >= 1, where all |x -
/// p_i|^2 - w_i are equal: each coordinate is the nearest double. `weighted`: p[i][d] is w_i, else
/// zero.
void circumcentre(unsigned d, unsigned k, bool weighted, const double* const* p, double* out);

/// Decides exactly whether the sphere through p[0 .. k] (within their flat) has a radius of at most
/// `radius`, which is finite and not negative.
bool radius_at_most(unsigned d, unsigned k, const double* const* p, double radius);

/// Returns the least double that is at least that radius; infinity beyond the range of doubles.
double radius_above(unsigned d, unsigned k, const double* const* p);

/// Computes the direction in the flat of the facet p[0 .. k) and the point `opposite` that is
/// orthogonal to the facet and points away from `opposite`, scaled by a positive number so that the
/// largest component is in [0.5, 1] in magnitude: each component within relative error 2^-50 of
/// exact.
void outward_direction(unsigned d, unsigned k, const double* const* p, const double* opposite,
                       double* out);

}  // namespace cullhull::internal
