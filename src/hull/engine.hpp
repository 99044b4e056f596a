// What a hull engine takes and gives. Engines see full-dimensional points only (the pipeline
// reduces flats first) and know nothing of files, filters or canonical order.
#pragma once

#include <cstdint>
#include <vector>

#include "cullhull/array.hpp"
#include "geometry/local_points.hpp"
#include "parallel/control.hpp"

namespace cullhull::internal {

/// The boundary as simplices, d local ids each, every ridge shared by two. Coplanar neighbours and
/// vertices that are not extreme (inside a face) may occur: result/ merges and drops them.
struct SimplicialHull {
  unsigned dimension = 0;
  /// facets x d ids; orientation(v0, ..., v(d-1), x) is negative for x inside (the hull lies
  /// beneath).
  Array<std::uint32_t> vertices;
  /// facets x d: entry j is the facet across the ridge opposite to vertex j.
  Array<std::uint32_t> neighbours;
  /// Pairs (duplicate, vertex): `duplicate` is a point equal to the vertex it was inserted as. The
  /// result takes the lowest id among equals.
  std::vector<std::pair<std::uint32_t, std::uint32_t>> duplicates;
  std::uint64_t rung_counts[3] = {0, 0, 0};

  std::size_t facet_count() const { return dimension ? vertices.size() / dimension : 0; }
};

/// Bytes that a result takes for each facet of a hull of dimension k in d-space, at its making.
constexpr std::uint64_t result_bytes_per_facet(std::uint64_t k, std::uint64_t d) {
  return k < 4 ? 48 * k + 8 * d + 44 : 36 * k + 8 * d + 40;
}

/// points.dimension >= 2. `simplex`: d + 1 affinely independent points to start from (exactly).
/// `budget`: bytes the engine may take before it throws Error{out_of_budget}.
SimplicialHull hull_2d(const LocalPoints& points, unsigned threads, const Control& control);
SimplicialHull hull_3d(const LocalPoints& points, const std::uint32_t* simplex,
                       std::uint64_t budget, unsigned threads, const Control& control);
/// `same_facets`: the same simplices in the same order for any number of threads, which takes a
/// little longer; else the surface is the same, but coplanar pieces and the order may not be.
SimplicialHull hull_nd(const LocalPoints& points, const std::uint32_t* simplex,
                       std::uint64_t budget, unsigned threads, const Control& control,
                       bool same_facets = false);
/// Qhull's answer, or Error{backend_unavailable} when built without libqhull_r, or
/// Error{not_exact} when Qhull fails or its facets are no closed simplicial surface.
SimplicialHull hull_qhull(const LocalPoints& points, const Control& control);
bool qhull_available();

}  // namespace cullhull::internal
