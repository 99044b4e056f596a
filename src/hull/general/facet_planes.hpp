// Planes of new facets in single precision, many at a time or one in any dimension, and the sieve
// that tests points against a few of them.
#pragma once

#include <cstddef>
#include <cstdint>

namespace cullhull::internal::inline hull {

/// The input of planes. Facets are rows of d ids; their planes are scaled to n . (x - O) = 1 and
/// stored as d + 1 floats, the last being the error E: for g~ = n . y in f32 with y = x - O rounded
/// to f32, |g~ - g| <= E max(1, |g|) (docs/exactness.md, "Cached planes"). Where no finite bound is
/// proved: n = 0, E = infinity.
struct PlaneFrame {
  unsigned dimension = 0;
  const double* rows = nullptr;    ///< points, packed rows, |x| <= 1
  const double* centre = nullptr;  ///< O, or O rounded
  const double* reach = nullptr;   ///< at least |x - O| of every point, per axis
  double radius = 0;               ///< at least |x - O| of every point; for plane_between()
  bool exact_rows = true;          ///< rows are the points themselves (no underflow in scaling)
};

/// `count` facets that share the point `apex`, which is entry apex_slot[i] of facet i. Planes go to
/// planes[i * (d + 1)]. Time: about 25 ns a facet in 4D to 150 ns in 8D; any d.
void facet_planes(const PlaneFrame& frame, std::uint32_t apex, const std::uint32_t* facets,
                  const std::uint8_t* apex_slot, std::size_t count, float* planes);

/// Planes in any dimension, one facet at a time. `wide`, unless null: as `planes`, in doubles, for
/// plane_between(); their error bounds that of n . (x - O) for all points x, infinity for none.
void facet_planes_any(const PlaneFrame& frame, const std::uint32_t* facets, std::size_t count,
                      float* planes, double* wide = nullptr);

/// The plane through a point and the ridge between a facet that the point sees and one that it does
/// not see: a sum of these two facets' wide planes. False where its error would be too large. Time:
/// O(d). docs/exactness.md, "Planes from neighbours".
bool plane_between(const PlaneFrame& frame, const double* seen, const double* unseen,
                   std::uint32_t point, float* plane, double* wide);

// Finds the points strictly inside a polytope of few facets by testing every point against every
// facet, many points at a time. Below some thousand facets that takes less than searching for the
// facet that a point's ray meets.

/// Points of one call.
inline constexpr std::size_t sieve_block = 64;
inline constexpr unsigned sieve_min_dimension = 4, sieve_max_dimension = 8;

/// Facet i has the normal planes[i * (d + 1) + j], j < d, and the level planes[i * (d + 1) + d]. Of
/// point k, y[j * sieve_block + k], j < d: beneath[k] becomes 1 where n . y < level for every
/// facet, the sum being taken in f32 in any order; else 0. With planes as in facet_planes.hpp and
/// levels 1 - E, beneath[k] proves that the point is strictly inside (docs/exactness.md, "Planes in
/// single precision"). `count` > 0. Time: about 0.05 ns for each point and facet in 4D.
void beneath_facets(unsigned d, const float* planes, std::size_t count, const float* y,
                    std::uint8_t* beneath);

}  // namespace cullhull::internal::inline hull
