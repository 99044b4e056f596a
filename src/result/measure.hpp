// Volume, area, centroid and facet planes of a hull whose combinatorics are final.
#pragma once

#include "cullhull/hull.hpp"
#include "parallel/control.hpp"

namespace cullhull::internal {

/// Fills volume, area, centroid and facet_planes from the other fields. `axes`: k coordinate axes
/// on which the points' flat projects one to one. Sums run in canonical order over chunks of fixed
/// size, so the bits do not depend on `threads`. `vertex_index[i * k + j]`: position, in ascending
/// order of ids, of vertex j of simplex i; `vertices`: those ids.
void measure(const PointView& points, const std::vector<std::uint64_t>& vertices,
             const std::vector<std::uint32_t>& vertex_index, const unsigned* axes, unsigned threads,
             const Control& control, Hull& hull);

/// The sums alone, of a simplicial hull whose planes are there and for which sums in doubles have
/// been found wanting: it is thin.
void measure_thin(const PointView& points, const std::vector<std::uint64_t>& vertices,
                  const std::vector<std::uint32_t>& vertex_index, const unsigned* axes,
                  unsigned threads, const Control& control, Hull& hull);

}  // namespace cullhull::internal
