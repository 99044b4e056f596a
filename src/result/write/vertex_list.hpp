// The points that a surface uses, numbered by ascending id.
#pragma once

#include <cstdint>
#include <vector>

#include "parallel/memory/big_array.hpp"
#include "result/boundary.hpp"

namespace cullhull::internal::inline result {

/// Positions among the vertices ascend as the local ids do.
struct VertexList {
  std::vector<std::uint64_t> ids;     ///< point ids, ascending
  bool all_points = false;            ///< every local point is a vertex: position = local id
  bool plain = false;                 ///< and its id too
  BigArray<std::uint32_t> positions;  ///< of local ids that are vertices; empty if all are

  std::uint32_t position(std::uint32_t local) const {
    return all_points ? local : positions[local];
  }
};

/// `ids`: point id of each of `points` local ones; nullptr: the same.
VertexList list_vertices(const Boundary& surface, std::uint32_t points, const std::uint64_t* ids,
                         const Run& run);

}  // namespace cullhull::internal::inline result
