// Computes the canonical result from an engine's simplicial boundary.
#pragma once

#include <cstdint>
#include <vector>

#include "cullhull/hull_fwd.hpp"
#include "hull/engine.hpp"
#include "hull/space/triangle_mesh.hpp"

namespace cullhull::internal {

/// The points of a call, as the caller and as the engine see them.
struct ResultInput {
  const PointView* view = nullptr;     ///< the caller's points (measures, planes)
  const LocalPoints* local = nullptr;  ///< the engine's input: k = local->dimension
  /// The caller's id of each local point, ascending; nullptr: local point i has id i.
  const std::uint64_t* ids = nullptr;
  /// The k coordinate axes of the view onto which the local points are projected, ascending.
  const unsigned* axes = nullptr;
};

/// Whether a facet of a single simplex lists its vertices in the same order as hull.simplices, so
/// that both lists can share their memory.
constexpr bool facets_are_simplices(unsigned k) { return k == 1 || k == 3; }

/// Merges coplanar simplices (exactly), removes vertices that are not extreme, triangulates
/// canonically, sorts, and computes the measures. Consumes `boundary`. Fills every field of Hull
/// except statistics, of which it only increases rung_counts. Throws Error{not_exact} if the
/// boundary is not weakly convex or not closed, which only a wrong engine can cause.
void build_hull(const ResultInput& input, Boundary&& boundary, const Run& run, Hull& hull);
/// The same from the 3D engine's own facets, in fewer passes over memory.
void build_hull(const ResultInput& input, TriangleMesh&& boundary, const Run& run, Hull& hull);

}  // namespace cullhull::internal
