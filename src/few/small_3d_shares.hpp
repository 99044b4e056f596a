// The arithmetic of small sets in space, many facets at a time.
#pragma once

#include <cstddef>
#include <cstdint>

#include "few/small_3d.hpp"
#include "result/measures/totals.hpp"

namespace cullhull::internal {

/// The contribution of each facet to the measures, as facet_share computes it.
template <unsigned room>
struct SmallShares : ShareArrays<room> {
  /// Bit mask of the facets that facet_share itself must compute: the normal may need more bits, or
  /// may be too short for products of it.
  std::uint64_t open[room / 64];
};

/// The shares and planes of all facets, the same bits as facet_share gives. `exponent`: of the
/// frame, below 1000 in magnitude. Planes are written for a multiple of eight facets.
void small_shares(const SmallPoints3D& points, const SmallHull3D& hull, int exponent,
                  SmallShares<SmallHull3D::max_facets>& shares, double* planes);
void small_shares(const MediumPoints3D& points, const MediumHull3D& hull, int exponent,
                  SmallShares<MediumHull3D::max_facets>& shares, double* planes);

/// Converts short numbers to longer ones, a vector at a time: reads and writes up to 64 bytes
/// beyond the last.
void widen(const std::uint8_t* from, std::size_t count, std::uint32_t* to);
void widen(const std::uint8_t* from, std::size_t count, std::uint64_t* to);
void widen(const std::uint16_t* from, std::size_t count, std::uint32_t* to);
void widen(const std::uint16_t* from, std::size_t count, std::uint64_t* to);

}  // namespace cullhull::internal
