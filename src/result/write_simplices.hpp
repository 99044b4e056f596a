// The result where every simplex is a facet, points in general position, for k >= 4.
#pragma once

#include "result/boundary.hpp"
#include "result/build_hull.hpp"
#include "result/measure_frame.hpp"
#include "result/vertex_list.hpp"

namespace cullhull::internal {

/// For k = 4 ... 8 = surface.dimension and a frame that is not wild: checks every ridge of the
/// surface, as `coplanar_pairs` does, and fills the hull from it in a few sweeps. Returns false,
/// with the hull's facets and measures untouched, where some simplices are coplanar and the
/// fallback must be gone. `vertices`: those of the surface; hull.vertices must hold their ids.
/// `key_bits`: of those that simplices are sorted by, at most 128; fewer, so that tests see what
/// happens if they do not do.
bool write_simplices(const ResultInput& input, const Boundary& surface, const VertexList& vertices,
                     const Frame& frame, const Run& run, Hull& hull, unsigned key_bits = 128);

}  // namespace cullhull::internal
