// The arithmetic of small sets in space, many facets at a time.
#pragma once

#include <cstddef>
#include <cstdint>

#include "result/totals.hpp"
#include "small/small_3d.hpp"

namespace cullhull::internal {

/// What each facet adds to the measures, as facet_share has it.
template <unsigned room>
struct SmallShares : ShareArrays<room> {
  /// Bits of the facets that facet_share itself must look at: the normal may need more bits, or may
  /// be too short for products of it.
  std::uint64_t open[room / 64];
};

/// The shares and planes of all facets, the same bits as facet_share gives. `exponent`: of the
/// frame; its magnitude is below 1000. Planes are written for a multiple of eight facets.
void small_shares(const SmallPoints3D& points, const SmallHull3D& hull, int exponent,
                  SmallShares<SmallHull3D::max_facets>& shares, double* planes);
void small_shares(const MediumPoints3D& points, const MediumHull3D& hull, int exponent,
                  SmallShares<MediumHull3D::max_facets>& shares, double* planes);

/// Short numbers to longer ones, a vector at a time: as many as 64 bytes are read and written
/// beyond the last.
void widen(const std::uint8_t* from, std::size_t count, std::uint32_t* to);
void widen(const std::uint8_t* from, std::size_t count, std::uint64_t* to);
void widen(const std::uint16_t* from, std::size_t count, std::uint32_t* to);
void widen(const std::uint16_t* from, std::size_t count, std::uint64_t* to);

}  // namespace cullhull::internal
