// A triangulation stored for walks: vertices along a curve, cells near their vertices.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "cullhull/array.hpp"
#include "cullhull/triangulation.hpp"
#include "geometry/curve_frame.hpp"
#include "parallel/adjacency.hpp"
#include "parallel/threads/run.hpp"

namespace cullhull::internal {

struct WalkMesh {
  WalkMesh(const PointView& points, const Triangulation& t, std::span<const double> weights,
           const Run& run);

  unsigned dimension = 0;     ///< d
  int affine_dimension = -1;  ///< k
  unsigned corners = 0;       ///< k + 1; 0 without cells
  unsigned stride = 0;        ///< numbers per row: d, with weights d + 1
  bool furthest = false;
  std::vector<std::uint32_t> columns;  ///< flat_columns()

  /// Vertices along the curve, as rows: coordinates in the order of `columns`, then the weight.
  Array<double> rows;
  Array<std::uint32_t> ids;   ///< the caller's id of each row
  Array<std::uint32_t> keys;  ///< the curve key of each row, ascending
  CurveFrame frame;

  /// For each cell k + 1 rows, then k + 1 neighbours as places in this list.
  Array<std::uint32_t> cells;
  Array<std::uint32_t> numbers;      ///< the caller's number of the cell at each place
  Array<std::uint32_t> places;       ///< place of each of the caller's cells
  Array<std::uint32_t> lowest_cell;  ///< for each row, the place of its cell of lowest number

  std::uint32_t vertex_count() const { return static_cast<std::uint32_t>(ids.size()); }
  const double* row(std::uint32_t v) const { return rows.data() + std::size_t{v} * stride; }
  const std::uint32_t* corners_of(std::uint32_t c) const {
    return cells.data() + std::size_t{c} * 2 * corners;
  }
  const std::uint32_t* neighbours_of(std::uint32_t c) const { return corners_of(c) + corners; }
  /// The row whose key is nearest to `key`; the search starts at row `from`.
  std::uint32_t row_at(std::uint32_t key, std::uint32_t from = 0) const;

 private:
  void take_vertices(const PointView& points, const Triangulation& t,
                     std::span<const double> weights, const Run& run);
  void take_cells(const Triangulation& t, const Array<std::uint32_t>& row_of, const Run& run);
};

/// The rows that share a cell with each row, ascending.
Adjacency<std::uint32_t> neighbour_rows(const WalkMesh& mesh, const Run& run);

}  // namespace cullhull::internal
