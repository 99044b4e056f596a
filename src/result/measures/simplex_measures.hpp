// Measures and planes of a simplex in many dimensions, all facets at once. docs/exactness.md, "Many
// dimensions".
#pragma once

#include <cstdint>
#include <vector>

#include "cullhull/hull_fwd.hpp"
#include "result/measures/measure_frame.hpp"

namespace cullhull::internal {

/// Up to this dimension simplices are measured as other hulls are, facet by facet.
inline constexpr unsigned measured_as_sum = 50;

/// Fills volume, area, centroid and facet_planes of a hull of k + 1 vertices. `index[i * k + j]`:
/// the position of vertex j of facet i among the vertices. Each number is the double nearest to one
/// with a relative error of 2^-300; a normal's component below 2^-300 is 0.
void measure_simplex(const Frame& frame, const std::vector<std::uint32_t>& index, const Run& run,
                     Hull& hull);

}  // namespace cullhull::internal
