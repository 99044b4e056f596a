// The simplicial result for k >= 4.
#pragma once

#include "result/build_hull.hpp"
#include "result/measure_frame.hpp"
#include "result/surface.hpp"
#include "result/vertex_list.hpp"

namespace cullhull::internal {

/// build_simplicial for k = 4 ... 8 = surface.k and a frame that is not wild. `key_bits`: of those
/// that simplices are sorted by, at most 128; fewer, so that tests see what happens if they do not
/// do.
bool build_simplicial_nd(const ResultInput& input, const Surface& surface,
                         const VertexList& vertices, const Frame& frame, unsigned threads,
                         const Control& control, Hull& hull, unsigned key_bits = 128);

}  // namespace cullhull::internal
