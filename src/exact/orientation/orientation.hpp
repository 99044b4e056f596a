// Exact orientation in any dimension: the ladder's rungs 2 and 3. docs/exactness.md has the proofs.
#pragma once

#include <cstdint>

namespace cullhull::internal {

enum class Sign : int { negative = -1, zero = 0, positive = 1 };

constexpr Sign operator-(Sign s) { return static_cast<Sign>(-static_cast<int>(s)); }
inline Sign sign_of(double v) {
  return v > 0 ? Sign::positive : v < 0 ? Sign::negative : Sign::zero;
}

/// The rung of the ladder that decided: (1) a cached plane, (2) a floating-point filter from the
/// coordinates, (3) exact arithmetic.
enum class Rung : std::uint8_t { plane = 0, filter = 1, exact = 2 };

/// The number of signs that each rung decided.
struct RungCounts {
  std::uint64_t of[3] = {0, 0, 0};

  void count(Rung rung) { ++of[static_cast<unsigned>(rung)]; }
  RungCounts& operator+=(const RungCounts& other) {
    other.add_to(of);
    return *this;
  }
  void add_to(std::uint64_t* totals) const {
    for (unsigned r = 0; r < 3; ++r) totals[r] += of[r];
  }
};

/// Sign of det [p1 - p0; p2 - p0; ...; pd - p0] (rows), for the d + 1 points p[0..d] of R^d, d
/// >= 1. Any finite doubles. Swapping two points flips the sign. d = 2: positive means p0, p1, p2
/// turn left. d = 3: positive means (p1 - p0) x (p2 - p0) points to p3's side. `rung`, if given,
/// receives the rung that decided (never Rung::plane).
Sign orientation(unsigned d, const double* const* p, Rung* rung = nullptr);

/// Does the same by exact arithmetic alone (integers scaled by powers of two).
Sign orientation_exact(unsigned d, const double* const* p);

/// Returns orientation(2, {a, b, c}) exactly: by the errors of two products if differences are
/// doubles, as on lattices and lines, else by integers. Rows of two coordinates.
Sign turn_exact(const double* a, const double* b, const double* c);

/// Sign of det [p0 - o; ...; p(d-1) - o], exactly, where o is the centroid of the d + 1 points
/// `simplex` (which need not be a double: the determinant is scaled by (d + 1)^d).
Sign orientation_from_centroid_exact(unsigned d, const double* const* p,
                                     const double* const* simplex);

/// Rank of the differences p[i] - p[0], i = 1 .. count-1, in R^d: the affine dimension of the
/// points, exactly. `columns`, if given, receives `rank` coordinate indices on which the projection
/// of the points keeps that rank (the flat projects onto them one to one), ascending.
unsigned affine_rank_exact(unsigned d, const double* const* p, unsigned count,
                           unsigned* columns = nullptr);

/// Computes a hyperplane through d points of R^d by exact arithmetic, rounded at the end: its
/// normal (not normalised, scaled so that its largest component is in [0.5, 1]), each component
/// within relative error 2^-50 of exact (an exact zero is zero; below 2^-1022 it may underflow).
/// Orientation: normal . (x - p0) has the sign of orientation(p0, p1, ..., p(d-1), x). Returns
/// false if the points are affinely dependent.
bool plane_exact(unsigned d, const double* const* p, double* normal);

}  // namespace cullhull::internal
