// The result where every simplex is a facet: points in general position, the usual case for
// floating-point data and the only one where hulls have millions of facets.
#pragma once

#include "result/build_hull.hpp"
#include "result/measure_frame.hpp"
#include "result/surface.hpp"
#include "result/vertex_list.hpp"

namespace cullhull::internal {

/// Checks every ridge of the surface, as `coplanar_pairs` does, and fills the hull from it in a few
/// sweeps. Returns false, with the hull's facets and measures untouched, where that is not enough
/// and the general way must be gone: some simplices are coplanar, the hull is flat or of an extreme
/// shape, k is not 2 ... 8. `vertices`: those of the surface; hull.vertices must hold their ids.
bool build_simplicial(const ResultInput& input, const Surface& surface, const VertexList& vertices,
                      unsigned threads, const Control& control, Hull& hull);

}  // namespace cullhull::internal
