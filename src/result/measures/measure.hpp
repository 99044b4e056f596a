// Volume, area, centroid and facet planes of a hull whose combinatorics are final.
#pragma once

#include "cullhull/hull.hpp"
#include "parallel/threads/run.hpp"

namespace cullhull::internal::inline result {

/// Fills volume, area, centroid and facet_planes from the other fields. `axes`: k coordinate axes
/// on which the points' flat projects one to one. Sums run in canonical order over chunks of fixed
/// size, so the bits do not depend on `threads`. `vertex_index[i * k + j]`: position, in ascending
/// order of ids, of vertex j of simplex i; `vertices`: those ids.
void measure(const PointView& points, const std::vector<std::uint64_t>& vertices,
             const std::vector<std::uint32_t>& vertex_index, const unsigned* axes, const Run& run,
             Hull& hull);

/// Only the sums, for a simplicial hull with finished planes whose sums in doubles were not
/// accurate enough, as it is thin.
void measure_thin(const PointView& points, const std::vector<std::uint64_t>& vertices,
                  const std::vector<std::uint32_t>& vertex_index, const unsigned* axes,
                  const Run& run, Hull& hull);

}  // namespace cullhull::internal::inline result
