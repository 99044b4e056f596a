// Finds the extreme vertex in a direction, the point of the hull nearest to an outside point, and a
// bound of a point's distance from the hull of a few others.
#pragma once

#include <cstddef>
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

  /// The index of the vertex with the largest product, decided exactly; of several the lowest.
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
  Adjacency<std::uint32_t, std::uint32_t> neighbours_;  // the vertices that share an edge with each
  DirectionCube cube_;
  std::vector<std::uint32_t> hints_;
};

// The distance from a point to the convex hull of a few others, with a proof of an upper bound.

/// A convex combination of few points, the nearest to the origin that was found.
struct NearCombination {
  std::vector<std::uint32_t> places;  ///< indices of the rows, at most d + 1
  std::vector<double> weights;        ///< positive, of sum 1 up to rounding
};

/// Finds a NearCombination by Wolfe's algorithm ("Finding the nearest point in a polytope", 1976)
/// in doubles; only bound() is guaranteed. Deterministic. Reuses its memory: use one object per
/// thread.
class NearestInHull {
 public:
  explicit NearestInHull(unsigned dimension);

  /// `rows`: `count` >= 1 points, relative to the query point, |coordinate| <= 8. Returns false
  /// once a hyperplane shows that all rows are farther than about `enough`.
  bool search(const double* rows, std::size_t count, double enough);
  const NearCombination& found() const noexcept { return best_; }
  /// An upper bound of the distance from the origin to the hull of the found rows, rounding
  /// included: docs/exactness.md, "Simplification". `rows` may be rounded differences of two
  /// doubles.
  double bound(const double* rows) const;

 private:
  bool affine_minimum(const double* rows);
  bool enter(const double* rows, std::uint32_t row);
  void combine(const double* rows);
  double dot(const double* a, const double* b) const;

  unsigned d_;
  NearCombination now_, best_;
  std::vector<double> x_, affine_, basis_, triangle_, projections_;
};

}  // namespace cullhull::internal
