// For each cell of directions the facets by which a ray through it may leave: many points asked at
// once are compared with those few, without a climb.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "parallel/run.hpp"
#include "query/direction_cube.hpp"
#include "query/facet_search.hpp"

namespace cullhull::internal {

/// What the kernel reads.
struct FacetCellTable {
  static constexpr unsigned max_k = 4;
  static constexpr unsigned group = 4;  // facets compared at a time

  unsigned k = 0;
  double low[max_k] = {}, high[max_k] = {};       // the vertices' box
  double factor[max_k] = {}, centre[max_k] = {};  // of FacetSearch::localise
  double resolution = 0, per_face = 0;
  double error_factor = 0;            // not less than that of any facet in a list
  std::vector<double> normals;        // facets x k
  std::vector<std::uint32_t> starts;  // cells + 1, in groups; an empty list: ask elsewhere
  std::vector<std::uint32_t> facets;  // groups x `group`; the first fills up the last group
};

class FacetCells {
 public:
  /// Points of one call of sides().
  static constexpr std::uint32_t block = 256;

  /// Null where there is nothing to gain: k above 4, or doubles found no point inside.
  static std::unique_ptr<FacetCells> build(const FacetSearch& search, const QueryPoints& points,
                                           const Run& run);
  /// Below this many points the cells are not worth making.
  static std::uint64_t worthwhile(const FacetSearch& search);

  /// Of `count` <= block points, coordinate j of point i at columns[j * block + i]: -1 for
  /// certainly inside, 1 for certainly outside, 0 for neither. False if some coordinate is not
  /// finite. The columns are written to beyond `count`, up to `block`.
  bool sides(double* columns, std::uint32_t count, std::int8_t* out) const;

 private:
  FacetCells() = default;
  FacetCellTable table_;
};

}  // namespace cullhull::internal
