// The result where every simplex is a facet, points in general position, for k >= 4.
#pragma once

#include "result/boundary.hpp"
#include "result/build_hull.hpp"
#include "result/measures/measure_frame.hpp"
#include "result/write/vertex_list.hpp"

namespace cullhull::internal::inline result {

/// For k = 4 ... 8 = surface.dimension and a frame that is not wild: checks every ridge of the
/// surface, as `coplanar_pairs` does, and fills the hull from it in a few sweeps. Returns false,
/// with the hull's facets and measures unchanged, where some simplices are coplanar, so that the
/// general code is needed. `vertices`: those of the surface; hull.vertices must hold their ids.
/// `key_bits`: length of the sorting keys, at most 128; tests pass less to reach the code for keys
/// that do not hold all vertices.
bool write_simplices(const ResultInput& input, const Boundary& surface, const VertexList& vertices,
                     const Frame& frame, const Run& run, Hull& hull, unsigned key_bits = 128);

}  // namespace cullhull::internal::inline result
