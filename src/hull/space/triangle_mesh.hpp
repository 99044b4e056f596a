// The 3D engine's own facets and numbering, in which neighbours are near one another in memory. The
// results of large 3D hulls are made from this; all else uses the Boundary.
#pragma once

#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "cullhull/hull_fwd.hpp"
#include "exact/orientation/orientation_3d.hpp"
#include "exact/points/local_points.hpp"
#include "hull/engine.hpp"
#include "hull/space/insertion_3d.hpp"
#include "parallel/memory/raw_array.hpp"

namespace cullhull::internal {

/// A surface of triangles in the engine's records: slots of facets, some of them unused.
struct TriangleMesh {
  using Run = std::pair<std::uint32_t, std::uint32_t>;

  RawArray<Facet3D> facets;
  /// Ranges of slots, ascending and not adjoining, that were ever used: facets in them may be live
  /// or dead.
  std::vector<Run> used;
  std::uint64_t live = 0;                   ///< number of live facets
  BigArray<std::uint32_t> order;            ///< local id of each vertex number
  BigArray<double> rows;                    ///< coordinates of each, Shared3D::row_stride apart
  std::uint32_t count = 0;                  ///< number of vertex numbers; some may not be in use
  std::optional<Orientation3D> predicates;  ///< for the local points, which it refers to
  /// As in Boundary.
  std::vector<std::pair<std::uint32_t, std::uint32_t>> duplicates;
  RungCounts rung_counts;

  /// The used slots in ranges of at most `length`.
  std::vector<Run> runs(std::uint32_t length) const;
};

/// Arguments as for hull_3d.
TriangleMesh triangle_mesh(const LocalPoints& points, const std::uint32_t* simplex, const Run& run);

/// The facets numbered by ascending slot, with local ids.
Boundary boundary_of(TriangleMesh&& surface, const Run& run);

// The surface of a hull in space whose vertices have moved.

/// The triangles and vertices of a hull, numbered breadth first so that neighbours are near in
/// memory.
struct NearbyNumbers {
  explicit NearbyNumbers(const Hull& hull);
  std::vector<std::uint32_t> order;       ///< each vertex's position among the hull's vertices
  std::vector<std::uint32_t> vertices;    ///< of each triangle, by these numbers
  std::vector<std::uint32_t> neighbours;  ///< of each triangle: triangles, by these numbers
};

/// Whether one thread mends so many concave ridges, and inserts so many new points, before all
/// threads hull all `count` points.
bool worth_mending(std::uint64_t changes, std::uint64_t count, const Run& run);

/// The local points that are the vertices of a hull, in their order, then all others; empty: 0, 1,
/// ... `ids`: those of the local points, ascending; null: 0, 1, ... Nothing if a vertex is missing,
/// or where the others are so many that the engine's threads hull all points sooner than one thread
/// inserts them.
std::optional<std::vector<std::uint32_t>> vertices_first(const std::vector<std::uint64_t>& vertices,
                                                         const std::uint64_t* ids,
                                                         std::uint32_t count, const Run& run);

/// The triangles of `last`, a 3D hull whose facets are all triangles, with its vertices moved:
/// vertex i of `last` is now local point order[i]. Empty where too many ridges are concave now, and
/// unless the triangles are provably star-shaped: one inner point is beneath every triangle, and
/// every ray from it meets exactly one. Such a surface is the points' hull if they are its vertices
/// and all its ridges are convex, which write_triangles checks; else mend_surface may help.
/// `numbers`: those of `last`, or null. docs/moving-points.md, "The last hull's triangles".
std::optional<TriangleMesh> moved_surface(const Hull& last, const NearbyNumbers* numbers,
                                          const std::vector<std::uint32_t>& order,
                                          const LocalPoints& points, const std::uint32_t* simplex,
                                          const Run& run);

/// Makes the points' hull, as triangle_mesh() does, of a surface that moved_surface() gave.
/// False where too much has changed; the surface is of no use then.
bool mend_surface(TriangleMesh& surface, const LocalPoints& points, const std::uint32_t* simplex,
                  const Run& run);

}  // namespace cullhull::internal
