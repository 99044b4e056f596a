// delaunay() for callers that go on with the prepared points.
#pragma once

#include "cullhull/triangulation.hpp"
#include "delaunay/prepare.hpp"

namespace cullhull::internal::inline delaunay {

/// As delaunay(). `prepared` becomes the points in the order of insertion, but without their
/// duplicates, which are in the result; it is unchanged if there are no points.
Triangulation triangulate(const PointView& points, const TriangulationOptions& options,
                          Prepared& prepared);

}  // namespace cullhull::internal::inline delaunay
