// Facets by cells of directions: the table that batches of points are tested by, on the CPU and on
// devices.
#pragma once

#include <cstdint>
#include <vector>

namespace cullhull::internal {

/// What both need besides the lists: how a point is localised and its cell found, and the bounds.
struct FacetCellFrame {
  static constexpr unsigned max_k = 4;
  static constexpr unsigned group = 4;  // facets compared at a time
  /// Points whose largest |coordinate|, localised, is smaller are left undecided: see
  /// FacetCells::build.
  static constexpr double least_reach = 0x1p-500;
  /// An upper bound of what underflow adds to a value: determinant_tiny over the least denominator
  /// allowed, with room.
  static constexpr double value_tiny = 0x1p-90;

  double low[max_k] = {}, high[max_k] = {};       // the vertices' bounding box
  double factor[max_k] = {}, centre[max_k] = {};  // of FacetSearch::localise
  std::uint32_t resolution = 0;
  double error_factor = 0;  // the largest of all listed facets
};

/// The facets of a hull of k = 2, 3 or 4 dimensions through which rays in a cell may leave.
struct FacetCellTable : FacetCellFrame {
  unsigned k = 0;
  std::vector<double> normals;        // facets x k
  std::vector<std::uint32_t> starts;  // cells + 1, in groups; an empty list: undecided
  std::vector<std::uint32_t> facets;  // groups x `group`; the last group is padded with the first
};

}  // namespace cullhull::internal
