// delaunay() for callers that also need the prepared points.
#pragma once

#include "cullhull/triangulation.hpp"
#include "delaunay/prepare.hpp"

namespace cullhull::internal {

/// As delaunay(). Sets `prepared` to the points in the order of insertion, without duplicates
/// (which are in the result); unchanged if there are no points.
Triangulation triangulate(const PointView& points, const TriangulationOptions& options,
                          Prepared& prepared);

}  // namespace cullhull::internal
