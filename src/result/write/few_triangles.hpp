// The hull of few points in space as an engine without dynamic memory leaves it, and its result.
#pragma once

#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "cullhull/point_view.hpp"
#include "result/measures/totals.hpp"

namespace cullhull::internal {

/// Simplices and facets in canonical order: each simplex from its lowest vertex, counter-clockwise
/// seen from outside; the simplices ascending. Lists are read one SIMD vector at a time, so arrays
/// have room beyond their ends; copies of the last simplex pad their number to a multiple of eight.
template <unsigned most>
struct SmallHull {
  static constexpr unsigned max_points = most, max_facets = 2 * max_points;
  static constexpr unsigned room = 3 * max_facets + 64;
  /// The number of a point or a facet.
  using Number = std::conditional_t<(max_facets <= 256), std::uint8_t, std::uint16_t>;

  double low[3], high[3];  ///< least and largest coordinates
  unsigned count = 0;      ///< of simplices
  unsigned facet_count = 0;
  unsigned vertex_count = 0;
  Number ids[max_points];  ///< of the vertices, ascending
  Number vertices[room];   ///< three ids per simplex
  Number opposite[room];   ///< the simplices opposite to each of them
  Number beside[room];     ///< the facets across the edge from each corner to the next

  bool simplicial() const { return facet_count == count; }
  /// Valid only where some facet has several simplices: each facet's number of corners, all facets'
  /// corners (`beside` then has an entry for each of these), and the facet of each simplex.
  Number facet_size[max_facets];
  Number corners[room];
  Number facet_of[room];
};
/// All its arrays fit the L1 cache.
using SmallHull3D = SmallHull<128>;
/// For filtered points, few of which stay vertices: up to 2048 points, testing each against all
/// facets was measured to be faster than searching for a visible facet.
using MediumHull3D = SmallHull<2048>;

/// Coordinates of up to `most` points. Rows are read up to the next multiple of sixteen: pad them
/// with copies of one of the points.
template <unsigned most>
struct SmallPoints {
  alignas(64) double axes[3][most];
};
using SmallPoints3D = SmallPoints<SmallHull3D::max_points>;
using MediumPoints3D = SmallPoints<MediumHull3D::max_points>;

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

/// Appends planes, measures and lists of the hull `small` of `points`, those of the view with the
/// given names, which ascend (nullptr: 0, 1, ...), to a Hull or a HullBatch; `shares` is working
/// memory. False, with the target unchanged, where a measure needs more than doubles.
template <class Points, class Small, class Target>
bool write_few_triangles(const PointView& view, const std::uint64_t* names, const Points& points,
                         const Small& small, SmallShares<Small::max_facets>& shares,
                         Target& target);

}  // namespace cullhull::internal
