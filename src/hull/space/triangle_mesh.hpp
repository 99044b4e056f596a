// The 3D engine's own facets and numbering, in which neighbours are near one another in memory. The
// results of large 3D hulls are made from this; all else uses the Boundary.
#pragma once

#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "exact/orientation/orientation_3d.hpp"
#include "hull/engine.hpp"
#include "hull/space/insertion_3d.hpp"
#include "parallel/memory/big_array.hpp"
#include "parallel/memory/raw_array.hpp"
#include "parallel/threads/run.hpp"

namespace cullhull::internal::inline hull {

/// A surface of triangles in the engine's records: slots of facets, some of them unused.
struct TriangleMesh {
  using Run = std::pair<std::uint32_t, std::uint32_t>;

  RawArray<Facet3D> facets;
  /// Ranges of slots, ascending and not adjoining, that were ever used: facets in them may be live
  /// or dead.
  std::vector<Run> used;
  std::uint64_t live = 0;                   ///< facets
  BigArray<std::uint32_t> order;            ///< local id of each vertex number
  BigArray<double> rows;                    ///< row of each, Shared3D::row_stride apart
  std::uint32_t count = 0;                  ///< number of vertex numbers; some may not be in use
  std::optional<Orientation3D> predicates;  ///< for the local points, which it refers to
  /// As in Boundary.
  std::vector<std::pair<std::uint32_t, std::uint32_t>> duplicates;
  RungCounts rung_counts;

  /// The used slots in ranges of at most `length`.
  std::vector<Run> runs(std::uint32_t length) const;
};

/// As hull_3d.
TriangleMesh triangle_mesh(const LocalPoints& points, const std::uint32_t* simplex, const Run& run);

/// The facets numbered by ascending slot, with local ids.
Boundary boundary_of(TriangleMesh&& surface, const Run& run);

}  // namespace cullhull::internal::inline hull
