// The surface of a hull in space whose vertices have moved.
#pragma once

#include <cstdint>
#include <optional>

#include "cullhull/hull.hpp"
#include "geometry/local_points.hpp"
#include "hull/space/triangle_mesh.hpp"
#include "parallel/run.hpp"

namespace cullhull::internal {

/// The triangles of `last`, a hull in 3D with a triangle for each facet, between the points of
/// which local point i is vertex i of `last`, where they are now. Empty unless they are certainly
/// star-shaped: each is seen from one point within from beneath, and every ray from there meets one
/// of them. Such a surface is the points' hull where all its ridges are convex, which
/// write_triangles checks. docs/moving-points.md, "The last hull's triangles".
std::optional<TriangleMesh> moved_surface(const Hull& last, const LocalPoints& points,
                                          const std::uint32_t* simplex, const Run& run);

}  // namespace cullhull::internal
