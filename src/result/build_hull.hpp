// From an engine's simplicial boundary to the canonical result.
#pragma once

#include <cstdint>
#include <vector>

#include "cullhull/hull.hpp"
#include "hull/engine.hpp"
#include "hull/space/triangle_mesh.hpp"
#include "parallel/threads/run.hpp"

namespace cullhull::internal::inline result {

struct ResultInput {
  const PointView* view = nullptr;     ///< the caller's points (measures, planes)
  const LocalPoints* local = nullptr;  ///< the engine's input: k = local->dimension
  /// Point id of local point i; ascending; nullptr: the identity.
  const std::uint64_t* ids = nullptr;
  /// The k coordinate axes of the view that the local points are projected on, ascending.
  const unsigned* axes = nullptr;
};

/// Whether a facet that is one simplex lists the simplex's vertices in the order of `simplices`.
constexpr bool facets_are_simplices(unsigned k) { return k == 1 || k == 3; }

/// Merges coplanar simplices (exactly), drops vertices that are not extreme, triangulates
/// canonically, sorts, and measures. Consumes `boundary`. Fills every field of Hull but statistics
/// (whose rung_counts it increases). Throws Error{not_exact} if the boundary is not weakly convex
/// or not closed (only a foreign engine can do that).
void build_hull(const ResultInput& input, Boundary&& boundary, const Run& run, Hull& hull);
/// The same from the 3D engine's own facets, which takes fewer passes.
void build_hull(const ResultInput& input, TriangleMesh&& boundary, const Run& run, Hull& hull);

}  // namespace cullhull::internal::inline result
