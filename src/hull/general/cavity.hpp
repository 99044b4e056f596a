// The data of one insertion: the facets visible from a point, their border, and a worker's scratch.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <utility>
#include <vector>

#include "exact/orientation/orientation.hpp"
#include "hull/general/ridge_pairs.hpp"
#include "parallel/memory/raw_array.hpp"

namespace cullhull::internal {

/// A ridge between a facet that is visible from the point and one that is not.
struct HorizonRidge {
  std::uint32_t facet, outside;
  std::uint8_t apex;  ///< index in `facet` of the vertex opposite to the ridge
  std::uint8_t back;  ///< index in `outside` of the vertex opposite to the ridge
};

/// A range of the insertion order, of points near one another, and the cavity of its next point.
struct Stream {
  std::uint32_t next = 0, end = 0;
  std::uint32_t hint = 0;  ///< a facet near the last point
  bool found = false;      ///< visible and horizon are those of point `next`
  bool accepted = false;
  /// The `seen` visible facets; after acceptance also extra slots, if there are more new facets
  /// than visible ones.
  std::vector<std::uint32_t> visible;
  std::size_t seen = 0;
  std::vector<HorizonRidge> horizon;
};

/// A worker's part of a batch; workers that finish early steal from the others.
struct alignas(64) WorkShare {
  std::atomic<std::size_t> next{0};
  std::size_t end = 0;
};

/// The scratch memory of one worker.
struct Lane {
  void cover(std::size_t facets) {
    if (visited_size >= facets) return;
    visited.reserve(facets);
    std::memset(visited.data() + visited_size, 0, facets - visited_size);
    visited_size = facets;
  }

  explicit Lane(unsigned d) : candidates(d + 1), offset(d), rows(d + 1), simplex_rows(d + 1) {
    if (d <= 8) minors.resize(std::size_t{1} << d);
  }
  RawArray<std::uint8_t> visited;  ///< a flag per facet slot; all zero between searches
  std::size_t visited_size = 0;
  std::vector<std::uint32_t> vertices, neighbours;  // of the new facets
  RidgePairs pairs;
  std::vector<std::uint32_t> candidates;
  std::vector<std::uint8_t> apex;
  std::vector<float> planes;
  std::vector<double> wide;   // planes in doubles, beyond 8D
  std::vector<float> offset;  // the point relative to O
  std::vector<const double*> rows, simplex_rows;
  std::vector<double> minors;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> duplicates;
  RungCounts rung_counts;
  std::uint64_t streams_done = 0;  ///< in phases that several workers shared
};

}  // namespace cullhull::internal
