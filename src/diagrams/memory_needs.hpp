// How much memory the diagrams of a triangulation take: estimates from measured peaks of balls in 2
// to 5 dimensions, so that a step is refused before its work.
#pragma once

#include <cstdint>

#include "cullhull/triangulation.hpp"
#include "cullhull/voronoi.hpp"
#include "parallel/threads/run.hpp"

namespace cullhull::internal {

/// Bytes for each cell of the triangulation that voronoi() needs beside it: vertices, the cells
/// around each edge, ridges and regions, and lists that grow.
constexpr std::uint64_t voronoi_bytes_per_cell(unsigned k) {
  if (k == 2) return 105;
  if (k == 3) return 230;
  return 8 * k + 24 * (k + 1) + 5 * k * (k + 1);
}
constexpr std::uint64_t voronoi_bytes(std::uint64_t points, std::uint64_t cells, unsigned d,
                                      unsigned k) {
  return points * 8 * (d + 4) + cells * voronoi_bytes_per_cell(k);
}

/// Bytes that clip_voronoi() needs beside the triangulation; less if it is given the diagram.
/// `shapes`: with the cells' shapes, not only their measures.
constexpr std::uint64_t clip_bytes(std::uint64_t points, std::uint64_t cells, unsigned d,
                                   bool shapes, bool has_diagram) {
  const std::uint64_t measures = points * 8 * (d + 4) + cells * (d == 3 ? 210 : d == 2 ? 135 : 60);
  const std::uint64_t shape = !shapes ? 0 : points * (d == 3 ? 1850 : d == 2 ? 300 : 60);
  const std::uint64_t saved = !has_diagram ? 0 : cells * (d == 3 ? 80 : d == 2 ? 60 : 0);
  return measures + shape - saved;
}

/// Bytes that alpha shapes and concave hulls need beside the triangulation: the points' rows, and
/// for each cell a radius, its place in an order and its region.
constexpr std::uint64_t shape_bytes(std::uint64_t points, std::uint64_t cells, unsigned d) {
  return points * 8 * d + cells * 24;
}

/// Bytes that a triangulation holds, without its lists of points that are no vertices.
inline std::uint64_t held_bytes(const Triangulation& t) {
  return 4 * (t.cells.size() + t.neighbours.size() + t.cell_groups.size() + t.hull_facets.size() +
              t.hull_cells.size());
}
/// Bytes that a diagram holds.
inline std::uint64_t held_bytes(const Voronoi& v) {
  return 8 * (v.vertices.size() + v.ray_directions.size() + v.ridges.offsets.size() +
              v.regions.offsets.size()) +
         4 * (v.ridge_points.size() + v.ridges.items.size() + v.regions.items.size() +
              v.ray_vertices.size());
}

/// Before a step that needs so many bytes, which `what`, a plural noun, names: throws
/// Error{out_of_budget} if they exceed the budget. Returns memory that earlier steps freed to the
/// system where the caller has set a budget.
inline void begin_step(const Run& run, std::uint64_t bytes, const char* what) {
  if (run.options.memory_budget != 0) trim_pages(run.budget / 8);
  require_budget(run.budget, bytes, what);
}

}  // namespace cullhull::internal
