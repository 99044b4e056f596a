// The triangles of a surface that a filter found to be convex.
#pragma once

#include <cstdint>

#include "cullhull/array.hpp"

namespace cullhull::internal {

/// Triangles of numbered vertices, counterclockwise seen from outside: triangle t has
/// vertices[3 t ... 3 t + 2]; neighbours[3 t + k] is opposite to the k-th of them. order[v] is the
/// point that vertex v is, of those that are left. What is near in space is near in these lists.
/// Empty: none.
struct StarTriangles {
  Array<std::uint32_t> vertices, neighbours, order;
  std::size_t count() const { return vertices.size() / 3; }
};

}  // namespace cullhull::internal
