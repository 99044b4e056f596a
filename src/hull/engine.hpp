// The interface of hull engines. Engines get full-dimensional points only (the pipeline first
// reduces flat inputs to their own dimension) and know nothing of files, filters or canonical
// order.
#pragma once

#include <cstdint>
#include <vector>

#include "cullhull/array.hpp"
#include "exact/orientation/orientation.hpp"
#include "exact/points/local_points.hpp"

namespace cullhull::internal {

struct Run;
/// The hull's boundary as simplices of d local ids each; every ridge is shared by two. Simplices
/// may be coplanar with their neighbours, and vertices may lie inside a face: result/ merges the
/// former and removes the latter.
struct Boundary {
  unsigned dimension = 0;
  /// facets x d ids; orientation(v0, ..., v(d-1), x) is negative for x inside (the hull lies
  /// beneath).
  Array<std::uint32_t> vertices;
  /// facets x d: entry j is the facet across the ridge opposite to vertex j.
  Array<std::uint32_t> neighbours;
  /// Empty in an engine's result. After sort_simplices the ids of a simplex ascend, and odd[f] is
  /// set where the last two of simplex f must be swapped to orient it outward.
  Array<std::uint8_t> odd;
  /// Whether a ridge between a simplex and one of higher number may be coplanar. The engine has
  /// proved all other ridges strictly convex. Empty: it has proved nothing.
  std::vector<std::uint8_t> doubtful;
  /// Pairs (duplicate, vertex): `duplicate` is a point equal to a vertex. The result takes the
  /// lowest id among equal points.
  std::vector<std::pair<std::uint32_t, std::uint32_t>> duplicates;
  RungCounts rung_counts;

  std::size_t facet_count() const { return dimension ? vertices.size() / dimension : 0; }
  const std::uint32_t* simplex(std::size_t f) const { return vertices.data() + f * dimension; }
  /// Id j of simplex f as a result stores it: ascending, with the last two swapped where odd[f].
  std::uint32_t stored(std::size_t f, unsigned j) const { return simplex(f)[stored_slot(f, j)]; }
  unsigned stored_slot(std::size_t f, unsigned j) const {
    return odd[f] && j + 2 >= dimension ? 2 * dimension - 3 - j : j;
  }
};

/// Bytes per facet needed to build the result, for a hull of dimension k in d-space, summed over
/// its arrays. In 6D: 304 bytes; measured for the whole process: 313.
constexpr std::uint64_t result_bytes_per_facet(std::uint64_t k, std::uint64_t d) {
  return k < 4 ? 48 * k + 8 * d + 44 : 36 * k + 8 * d + 40;
}

/// points.dimension >= 2. `simplex`: d + 1 affinely independent points to start from. Engines throw
/// Error{out_of_budget} where they would exceed run.budget.
Boundary hull_2d(const LocalPoints& points, const Run& run);
Boundary hull_3d(const LocalPoints& points, const std::uint32_t* simplex, const Run& run);
/// `same_facets`: return the same simplices in the same order for every number of threads, which
/// costs some time. Otherwise their order and the division of coplanar facets may differ, but never
/// the surface.
Boundary hull_nd(const LocalPoints& points, const std::uint32_t* simplex, const Run& run,
                 bool same_facets = false);

}  // namespace cullhull::internal
