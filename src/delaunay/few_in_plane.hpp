// Delaunay triangulations of few points in the plane.
#pragma once

#include "cullhull/triangulation.hpp"

namespace cullhull::internal {

/// delaunay() for few points in the plane on the calling thread, with memory that the thread keeps:
/// the general path would spend most of its time on allocating, on sorting keys and on passes that
/// threads could share. Returns false for other points: more than 16,384, in clusters that
/// need finer keys for their order, collinear, not finite or of extreme magnitude.
bool triangulate_few_in_plane(const PointView& points, const TriangulationOptions& options,
                              Triangulation& out);

}  // namespace cullhull::internal
