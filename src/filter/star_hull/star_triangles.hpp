// The triangles of a surface that a filter found to be convex.
#pragma once

#include <cstdint>
#include <vector>

namespace cullhull::internal::inline filter {

/// Triangles of vertices 0, 1, ..., counterclockwise seen from outside: triangle t has
/// vertices[3 t ... 3 t + 2]; neighbours[3 t + k] is opposite to the k-th of them. Empty: none.
struct StarTriangles {
  std::vector<std::uint32_t> vertices, neighbours;
  std::size_t count() const { return vertices.size() / 3; }
};

}  // namespace cullhull::internal::inline filter
