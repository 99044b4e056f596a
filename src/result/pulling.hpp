// Triangulation of a polytope by pulling, from vertex sets alone.
#pragma once

#include <cstdint>
#include <vector>

namespace cullhull::internal::inline result {

using VertexSet = std::vector<std::uint32_t>;  // ascending

/// Appends to `out` (m + 1 ascending ids each) the triangulation of the m-dimensional polytope with
/// vertices `vertices` and facets `facets` that pulling its vertices in ascending order gives: cone
/// from the lowest vertex over the triangulated facets that do not contain it, recursively. It
/// depends on the face lattice and the ids alone. m >= 1.
/// Source: C. Lee, "Subdivisions and triangulations of polytopes", Handbook of Discrete and
/// Computational Geometry, section 16.2 (2017).
void pull(const VertexSet& vertices, unsigned m, const std::vector<VertexSet>& facets,
          std::vector<std::uint32_t>& out);

}  // namespace cullhull::internal::inline result
