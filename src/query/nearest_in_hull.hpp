// The distance from a point to the convex hull of a few others, with a proof of an upper bound.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace cullhull::internal::inline query {

/// A convex combination of few points, the nearest to the origin that was found.
struct NearCombination {
  std::vector<std::uint32_t> places;  ///< indices of the rows, at most d + 1
  std::vector<double> weights;        ///< positive, of sum 1 up to rounding
};

/// Finds it by Wolfe's algorithm ("Finding the nearest point in a polytope", 1976) in doubles; only
/// bound() is guaranteed. Deterministic. Keeps its memory: use one object a thread.
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

}  // namespace cullhull::internal::inline query
