// The data of one insertion: the facets visible from a point, their border, and a thread's scratch.
#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "exact/orientation/orientation.hpp"
#include "hull/general/ridge_pairs.hpp"

namespace cullhull::internal {

/// A ridge between a facet that is visible from the point and one that is not.
struct HorizonRidge {
  std::uint32_t facet, outside;
  std::uint8_t apex;  ///< index in `facet` of the vertex opposite to the ridge
  std::uint8_t back;  ///< index in `outside` of the vertex opposite to the ridge
};

/// What one thread needs to insert points: the cavity of its present point, the slots it may use,
/// and scratch memory.
struct Lane {
  Lane(unsigned d, std::uint16_t number_)
      : number(number_), offset(d), rows(d + 1), simplex_rows(d + 1) {
    if (d <= 8) minors.resize(std::size_t{1} << d);
  }
  std::uint16_t number;    ///< from 1 on
  std::uint32_t hint = 0;  ///< a facet near the last point
  /// The `seen` visible facets; then the slots of further new facets, if there are more of these.
  std::vector<std::uint32_t> visible;
  std::size_t seen = 0;
  std::vector<HorizonRidge> horizon;
  std::vector<std::uint32_t> unused;                ///< slots without a facet
  std::vector<std::uint32_t> held;                  ///< slots that no other lane may read
  std::vector<std::uint32_t> put_off;               ///< points
  std::size_t inserted = 0, made = 0, removed = 0;  ///< points; facets
  bool tied = false;  ///< whether some point lay in a facet's hyperplane

  std::vector<std::uint32_t> vertices, neighbours;  // of the new facets
  RidgePairs pairs;
  std::vector<std::uint8_t> apex;
  std::vector<float> planes;
  std::vector<double> wide;   // planes in doubles, beyond 8D
  std::vector<float> offset;  // the point relative to O
  std::vector<const double*> rows, simplex_rows;
  std::vector<double> minors;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> duplicates;
  RungCounts rung_counts;
};

}  // namespace cullhull::internal
