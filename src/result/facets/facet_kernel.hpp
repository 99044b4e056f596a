// Normals of eight simplices at a time.
#pragma once

#include <cstdint>

namespace cullhull::internal::inline result {

/// Eight simplices of K corners in R^K, lane by lane: input `corner` and `origin`, output the rest.
template <unsigned K>
struct FacetBlock {
  static constexpr unsigned lanes = 8;
  alignas(64) double corner[K][K][lanes];  ///< corner, coordinate
  alignas(64) double origin[K][lanes];     ///< the point that sums refer to
  /// As `cofactors` computes them, bit for bit.
  alignas(64) double normal[K][lanes];
  /// Sum over the corners of their differences from the origin.
  alignas(64) double sum[K][lanes];
  alignas(64) double length[lanes];  ///< of the normal
  alignas(64) double edges[lanes];   ///< product of the lengths of the edges from corner 0
  alignas(64) double reach[lanes];   ///< product of their largest coordinates
};

/// Every instruction set performs the same IEEE operations, so all give the same bits. K = 3 ... 8.
template <unsigned K>
void facet_block(FacetBlock<K>& block);

}  // namespace cullhull::internal::inline result
