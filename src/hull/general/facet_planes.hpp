// Planes of new facets in single precision: many at a time in 4D to 8D, one at a time in any
// dimension. And tests against all planes of a small hull: of many points, the sieve, and of one.
#pragma once

#include <cstddef>
#include <cstdint>

namespace cullhull::internal {

/// The points that planes are computed from. A facet is a row of d ids; its plane is scaled to n .
/// (x - O) = 1 and stored as d + 1 floats, the last of which is the error bound E: for g~ = n . y
/// in f32 with y = x - O rounded to f32, |g~ - g| <= E max(1, |g|) (docs/exactness.md, "Cached
/// planes"). Where no finite bound can be proved, n = 0 and E = infinity.
struct PlaneFrame {
  unsigned dimension = 0;
  const double* rows = nullptr;    ///< points, packed rows, |x| <= 1
  const double* centre = nullptr;  ///< O, or O rounded
  const double* reach = nullptr;   ///< upper bound of |x - O| over all points, per axis
  double radius = 0;               ///< upper bound of the distance |x - O|; for plane_between()
  bool exact_rows = true;          ///< rows are the points themselves (no underflow in scaling)
  double row_error = 0;            ///< more than underflow: LocalPoints::coordinate_error
};

/// Computes the planes of `count` facets that share the point `apex`, which is entry apex_slot[i]
/// of facet i, in any dimension; plane i begins at planes[i * (d + 1)]. Time per facet: from about
/// 25 ns in 4D to 150 ns in 8D.
void facet_planes(const PlaneFrame& frame, std::uint32_t apex, const std::uint32_t* facets,
                  const std::uint8_t* apex_slot, std::size_t count, float* planes);

/// Computes planes in any dimension, one facet at a time. `wide`, unless null, receives them in
/// doubles as well, for plane_between(); the last entry bounds the error of n . (x - O) for all
/// points x, and is infinity where no bound can be proved. `sharp`: refines planes, whatever their
/// bounds, because many others will be computed from them.
void facet_planes_any(const PlaneFrame& frame, const std::uint32_t* facets, std::size_t count,
                      float* planes, double* wide = nullptr, bool sharp = false);

/// Computes the plane through `point` and the ridge between a facet that it sees and one that it
/// does not see, as a linear combination of their wide planes. False where the error would be too
/// large. Time: O(d). docs/exactness.md, "Planes from neighbours".
bool plane_between(const PlaneFrame& frame, const double* seen, const double* unseen,
                   std::uint32_t point, float* plane, double* wide);

/// The gauge of a wide plane at points, and the bound of its error, by which ridges are proved
/// strictly convex. docs/exactness.md, "Ridges by the engine's planes".
class WideGauge {
 public:
  WideGauge(const PlaneFrame& frame, const double* wide);
  double of(std::uint32_t point) const;
  /// Whether the point is certainly strictly beneath the plane.
  bool surely_beneath(std::uint32_t point) const { return of(point) + doubt_ < 1 - 0x1p-40; }
  /// Whether the plane may go through the point.
  bool may_contain(std::uint32_t point) const {
    const double height = of(point) - 1;
    return height <= doubt_ && height >= -doubt_;
  }

 private:
  const PlaneFrame& frame_;
  const double* wide_;
  double doubt_;
};

// Finds the points strictly inside a polytope of few facets by testing every point against every
// facet, many points at a time. With fewer than some thousand facets this takes less time than
// searching for the facet that a point's ray meets.

/// Points per call.
inline constexpr std::size_t sieve_block = 64;
inline constexpr unsigned sieve_min_dimension = 4, sieve_max_dimension = 8;

/// Facet i has the normal planes[i * (d + 1) + j], j < d, and the level planes[i * (d + 1) + d];
/// point k has the coordinates y[j * sieve_block + k], j < d. Sets beneath[k] to 1 where n . y <
/// level for every facet (summed in f32 in any order), else to 0. With the planes of facet_planes()
/// and levels 1 - E, 1 proves that the point is strictly inside (docs/exactness.md, "Planes in
/// single precision"). `count` > 0. Time: about 0.05 ns for each point and facet in 4D.
void beneath_facets(unsigned d, const float* planes, std::size_t count, const float* y,
                    std::uint8_t* beneath);

/// The planes of 16 facets so that vectors hold the same entry of many: entry[j][i] is entry j of
/// facet i's plane; entry[D] has the error bounds. A plane of zeros is seen by no point.
template <unsigned D>
struct PlaneGroup {
  static constexpr unsigned size = 16;
  alignas(64) float entry[D + 1][size] = {};
};

/// Tests one point, y = x - O in f32, against the planes of facet_planes() in `count` PlaneGroups
/// that begin at `groups`. Sets the bit of each facet in `seen` if the point is certainly above it,
/// and in `open` if it is not certainly beneath it; other bits are cleared. Bit i % 8 of byte 2 g +
/// i / 8 belongs to facet i of group g; both lists need seen_room bytes beyond 2 count. Returns
/// whether any bit was set. Time: 0.15 to 0.3 ns for each facet in 4D.
inline constexpr std::size_t seen_room = 8;
bool seen_facets(unsigned d, const float* groups, std::size_t count, const float* y,
                 std::uint8_t* seen, std::uint8_t* open);

}  // namespace cullhull::internal
