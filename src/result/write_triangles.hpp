// The result in 3D where every triangle is a facet: points in general position.
#pragma once

#include "hull/space/surface_3d.hpp"
#include "result/build_hull.hpp"

namespace cullhull::internal {

/// Checks every ridge and fills the hull in a few sweeps over the engine's own facets. Returns
/// false, with surface and hull untouched but for their counts of rungs, where that is not enough
/// and the general way must be gone: some facets are coplanar, the points span too many powers of
/// two, the surface is not that of a hull. Otherwise the surface is used up. The points must be of
/// dimension 3 themselves.
bool build_simplicial_3d(const ResultInput& input, Surface3D& surface, unsigned threads,
                         const Control& control, Hull& hull);

}  // namespace cullhull::internal
