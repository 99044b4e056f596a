// The coordinates that a hull carries of its vertices, if Options::with_coordinates asked for them.
#pragma once

#include <cstdint>
#include <vector>

#include "cullhull/hull_fwd.hpp"
#include "cullhull/point_view.hpp"

namespace cullhull::internal {

/// Fills Hull::vertex_coordinates. `points`: those that the ids of the vertices number.
void write_coordinates(const PointView& points, Hull& hull);

/// The vertices of a hull that carries their coordinates, by ascending id.
struct OwnVertices {
  /// Error{invalid_argument} if the hull has no coordinates.
  explicit OwnVertices(const Hull& hull);

  PointView points() const { return PointView::row_major(rows.data(), ids.size(), dimension); }
  std::uint32_t dimension;
  std::vector<std::uint64_t> ids;
  std::vector<double> rows;
};

}  // namespace cullhull::internal
