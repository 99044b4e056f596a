// Finds the vertex extreme in a direction, and the point of the hull nearest to a point outside.
#pragma once

#include <cstdint>
#include <vector>

#include "parallel/adjacency.hpp"
#include "query/direction_cube.hpp"
#include "query/facet_search.hpp"

namespace cullhull::internal {

/// Vertices and their neighbours on the boundary. The vertices whose scalar product with a
/// direction is above some level are connected, so climbing finds the largest.
class VertexSearch {
 public:
  VertexSearch(const QueryPoints& points, const Control& control);

  /// The index of the vertex with the exactly largest product; of several the lowest.
  std::uint32_t support(const double* direction) const;

  struct Nearest {
    double distance = 0;
    /// Vertices of a boundary simplex that contains the nearest point.
    std::vector<std::uint32_t> corners;
  };
  /// Requires q outside. Wolfe 1976, "Finding the nearest point in a polytope".
  Nearest nearest(const double* q) const;

 private:
  double product(std::uint32_t v, const double* u) const;
  std::uint32_t climb(std::uint32_t from, const double* u) const;
  void join_neighbours(const Control& control);
  /// The sign of (vertex a - vertex b) . direction, exactly.
  int compare(std::uint32_t a, std::uint32_t b, const double* direction) const;

  const QueryPoints* points_;
  std::vector<double> factor_;  // powers of two that scale each axis into [-1, 1]
  std::vector<double> scaled_;  // vertices x dimension
  Adjacency<std::uint32_t, std::uint32_t> neighbours_;  // vertices at edges of each vertex
  DirectionCube cube_;
  std::vector<std::uint32_t> hints_;
};

}  // namespace cullhull::internal
