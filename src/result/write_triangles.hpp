// The result in 3D where every triangle is a facet: points in general position.
#pragma once

#include "hull/space/triangle_mesh.hpp"
#include "result/build_hull.hpp"

namespace cullhull::internal {

/// Checks every ridge and fills the hull in a few sweeps over the engine's own facets. Returns
/// false, with surface and hull untouched but for their counts of rungs, where that is not enough
/// and the fallback must be taken: some facets are coplanar, the points span too many powers of
/// two, the surface is not that of a hull. Otherwise the surface is used up. The points must be of
/// dimension 3 themselves.
bool write_triangles(const ResultInput& input, TriangleMesh& surface, const Run& run, Hull& hull);

}  // namespace cullhull::internal
