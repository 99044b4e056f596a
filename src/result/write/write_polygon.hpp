// The complete result of a hull in the plane, from its polygon. The cycle of corners determines
// everything: in canonical order simplex i is the edge from the corner with the i-th lowest id to
// the corner before it on the polygon.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "cullhull/point_view.hpp"
#include "geometry/box.hpp"
#include "parallel/memory/raw_array.hpp"
#include "parallel/threads/run.hpp"
#include "result/measures/share.hpp"

namespace cullhull::internal {

/// A polygon whose corners are some of the rows that an engine got. Id: an unsigned integer.
template <class Id>
struct PolygonOfRows {
  std::span<const std::uint32_t> corners;  ///< rows, counter-clockwise; at least three
  std::uint64_t rows;                      ///< their number
  const Id* ids;   ///< the id of each row's point, ascending; nullptr: the id is the row
  const Box& box;  ///< of the corners, which is also that of all points
};

/// The data of a corner in one record: the sweep over the edges accesses corners in random order.
struct PolygonCorner {
  double x, y;               // scaled by a power of two
  std::uint64_t id, unused;  // four words: no record straddles cache lines
};

/// Working memory of write_polygon: 32 bytes per corner and 12 per 64 rows.
struct PolygonMemory {
  RawArray<std::uint64_t> bits;    // which rows are corners
  RawArray<std::uint32_t> before;  // the number of corners before each word of these
  RawArray<std::uint32_t> ranks;   // of the corners, by row, where these are few
  RawArray<PolygonCorner> corners;
  std::vector<Share<2, DoubleDouble>> sums;
};

/// Fills the lists and measures of a Hull, or appends them to a HullBatch. Returns false, with
/// `target` unchanged, if build_hull is needed. (std::uint64_t, Hull), (std::uint32_t, either).
template <class Id, class Target>
bool write_polygon(const PointView& points, const PolygonOfRows<Id>& polygon, const Run& run,
                   PolygonMemory& memory, Target& target);

}  // namespace cullhull::internal
