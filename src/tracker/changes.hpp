// What came and went from one hull to the next.
#pragma once

#include "cullhull/hull.hpp"
#include "cullhull/track.hpp"

namespace cullhull::internal {

/// Ids of the vertices, ascending.
std::vector<std::uint64_t> ascending_vertices(const Hull& hull);

/// Fills the counts of vertices and facets that came and went. Linear in the sizes of the hulls.
void count_changes(const Hull& before, const Hull& after, FrameReport& report);

}  // namespace cullhull::internal
