// The vertex nearest to a point by walking over edges.
#pragma once

#include <cstdint>
#include <unordered_set>
#include <vector>

#include "diagrams/locate/walk_mesh.hpp"
#include "exact/orientation/orientation.hpp"

namespace cullhull::internal {

/// A thread's walks. The lifted vertices are those of a convex surface, over which a distance to q
/// is the surface less a linear function: a vertex that no neighbour betters is the best, and those
/// as good are connected.
class NearestVertex {
 public:
  /// `graph`: neighbour_rows().
  NearestVertex(const WalkMesh& mesh, const Adjacency<std::uint32_t>& graph)
      : mesh_(mesh), graph_(graph) {}

  /// The id of the nearest vertex, of several the lowest. `key`: of q.
  std::uint32_t find(const double* q, std::uint32_t key);

 private:
  /// Negative: a is nearer to q than b (for the furthest site: further).
  Sign compare(const double* q, std::uint32_t a, std::uint32_t b) const;
  std::uint32_t lowest_of_equal(const double* q, std::uint32_t row);

  const WalkMesh& mesh_;
  const Adjacency<std::uint32_t>& graph_;
  std::uint32_t row_ = no_cell;
  std::unordered_set<std::uint32_t> met_;
  std::vector<std::uint32_t> todo_;
};

}  // namespace cullhull::internal
