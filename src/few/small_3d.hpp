// The hull of a few points in space, without dynamic memory: for batches of small sets, and for the
// survivors of larger ones.
#pragma once

#include <cstdint>
#include <type_traits>

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

/// False for flat sets, for coordinates of extreme magnitude or not finite, and where too many
/// signs need exact arithmetic: the caller must then use another engine.
bool small_hull_3d(const SmallPoints3D& points, unsigned count, SmallHull3D& out);
bool small_hull_3d(const MediumPoints3D& points, unsigned count, MediumHull3D& out);

}  // namespace cullhull::internal
