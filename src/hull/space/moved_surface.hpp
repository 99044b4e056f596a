// The surface of a hull in space whose vertices have moved.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "cullhull/hull.hpp"
#include "exact/points/local_points.hpp"
#include "hull/space/triangle_mesh.hpp"
#include "parallel/threads/run.hpp"

namespace cullhull::internal::inline hull {

/// The triangles and vertices of a hull, numbered so that neighbours are near in memory, as ids
/// alone need not be: breadth first.
struct NearbyNumbers {
  explicit NearbyNumbers(const Hull& hull);
  std::vector<std::uint32_t> order;       ///< the position among the hull's vertices of each
  std::vector<std::uint32_t> vertices;    ///< of each triangle, by these numbers
  std::vector<std::uint32_t> neighbours;  ///< triangles, likewise
};

/// The triangles of `last`, a hull in 3D with a triangle for each facet, between the points of
/// which local point i is vertex i of `last`, where they are now. Empty unless they are certainly
/// star-shaped: each is seen from one point within from beneath, and every ray from there meets one
/// of them. Such a surface is the points' hull where all its ridges are convex, which
/// write_triangles checks. `numbers`: of `last`, or null. docs/moving-points.md, "The last hull's
/// triangles".
std::optional<TriangleMesh> moved_surface(const Hull& last, const NearbyNumbers* numbers,
                                          const LocalPoints& points, const std::uint32_t* simplex,
                                          const Run& run);

}  // namespace cullhull::internal::inline hull
