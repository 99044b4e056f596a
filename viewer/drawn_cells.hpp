// The cells of a triangulation that a page draws.
#pragma once

#include <cstdint>
#include <vector>

#include "cullhull/triangulation.hpp"

namespace cullhull::viewer {

struct DrawnCells {
  std::uint32_t corners = 0;        ///< of each cell: one more than the dimension of the points
  std::uint64_t points = 0;         ///< number of points triangulated, including duplicates
  std::vector<std::uint32_t> rows;  ///< cells x corners
};

/// The Delaunay triangulation of rows, which have ids[i] and `dimension` coordinates each; ties are
/// broken by id. If it exceeds `most_corners` numbers, that of a uniform sample of the rows.
/// `outline`: its cells in the alpha shape of one region.
DrawnCells drawn_cells(const std::vector<double>& ids, const std::vector<double>& coordinates,
                       std::uint32_t dimension, std::uint64_t most_corners,
                       const TriangulationOptions& options, bool outline);

}  // namespace cullhull::viewer
