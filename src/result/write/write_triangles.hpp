// The result in 3D where every triangle is a facet: points in general position.
#pragma once

#include "hull/space/triangle_mesh.hpp"
#include "result/build_hull.hpp"

namespace cullhull::internal::inline result {

/// Checks every ridge and fills the hull in a few sweeps over the engine's own facets. Returns
/// false, with surface and hull unchanged but for their counts of rungs, where the general code is
/// needed: some facets are coplanar, the points span too many powers of two, or the surface is not
/// that of a hull. Otherwise the surface is consumed. The points must have dimension 3.
bool write_triangles(const ResultInput& input, TriangleMesh& surface, const Run& run, Hull& hull);

}  // namespace cullhull::internal::inline result
