// What changed from one hull to the next.
#pragma once

#include "cullhull/hull.hpp"
#include "cullhull/track.hpp"

namespace cullhull::internal::inline tracker {

/// Counts vertices and facets that came and went. Linear in the sizes of the hulls.
void count_changes(const Hull& before, const Hull& after, FrameReport& report);

}  // namespace cullhull::internal::inline tracker
