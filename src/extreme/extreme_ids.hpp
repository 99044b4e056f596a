// The extreme points of a full-dimensional set, without its facets.
#pragma once

#include <cstdint>
#include <vector>

namespace cullhull::internal {

class LocalFrame;
struct Run;
/// Returns ascending local ids; of equal points the lowest. Time: for h of n points extreme, one
/// linear program over about h points for each of n, and one pass over all n for each of h. O(n d)
/// memory.
std::vector<std::uint32_t> extreme_ids(const LocalFrame& frame, const Run& run);

}  // namespace cullhull::internal
