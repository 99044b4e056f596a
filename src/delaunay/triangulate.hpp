// delaunay() and regular_triangulation() for callers that also need the prepared points, and parts
// of them in files of their own.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "cullhull/triangulation.hpp"
#include "delaunay/prepare.hpp"
#include "exact/points/local_points.hpp"

namespace cullhull::internal {

/// `weights`: none for delaunay(). Sets `prepared` to the points in the order of insertion, without
/// duplicates (which are in the result); unchanged if there are no points.
Triangulation triangulate(const PointView& points, std::span<const double> weights,
                          const TriangulationOptions& options, Prepared& prepared);

/// delaunay() for few points in the plane on the calling thread, with memory that the thread keeps:
/// the general path would spend most of its time on allocating, on sorting keys and on passes that
/// threads could share. Returns false for other points: more than 16,384, in clusters that
/// need finer keys for their order, collinear, not finite or of extreme magnitude.
bool triangulate_few_in_plane(const PointView& points, const TriangulationOptions& options,
                              Triangulation& out);

/// The redundant vertices of a regular triangulation, ascending: their lifted points are exactly on
/// a face of the lower hull of the others. Requires complete cells, hull and groups of `t`.
std::vector<std::uint32_t> redundant_vertices(const LiftedPoints& s, const Triangulation& t,
                                              const Run& run);

}  // namespace cullhull::internal
