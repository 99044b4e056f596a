// For each cell of directions, the facets that a ray through it may leave by: in batches, points
// are tested against these few facets instead of climbing.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "parallel/threads/run.hpp"
#include "query/direction_cube.hpp"
#include "query/facet_search.hpp"

namespace cullhull::internal::inline query {

/// The data of the kernel.
struct FacetCellTable {
  static constexpr unsigned max_k = 4;
  static constexpr unsigned group = 4;  // facets compared at a time

  unsigned k = 0;
  double low[max_k] = {}, high[max_k] = {};       // the vertices' bounding box
  double factor[max_k] = {}, centre[max_k] = {};  // of FacetSearch::localise
  double resolution = 0, per_face = 0;
  double error_factor = 0;            // the largest of all listed facets
  std::vector<double> normals;        // facets x k
  std::vector<std::uint32_t> starts;  // cells + 1, in groups; an empty list: undecided
  std::vector<std::uint32_t> facets;  // groups x `group`; the last group is padded with the first
};

class FacetCells {
 public:
  /// Points of one call of sides().
  static constexpr std::uint32_t block = 256;

  /// Null where it would gain nothing: k above 4, or no centre inside (exhaustive()).
  static std::unique_ptr<FacetCells> build(const FacetSearch& search, const QueryPoints& points,
                                           const Run& run);
  /// With fewer points building the cells takes longer than it saves: four points a cell.
  static std::uint64_t worthwhile(const FacetSearch& search);

  /// For `count` <= block points, coordinate j of point i at columns[j * block + i]: -1 for
  /// certainly inside, 1 for certainly outside, 0 for undecided. False if some coordinate is not
  /// finite. Overwrites the columns from `count` to `block`.
  bool sides(double* columns, std::uint32_t count, std::int8_t* out) const;

 private:
  FacetCells() = default;
  FacetCellTable table_;
};

}  // namespace cullhull::internal::inline query
