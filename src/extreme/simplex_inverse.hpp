// A simplex that points can be tested against quickly, with a proof.
#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "exact/points/local_points.hpp"

namespace cullhull::internal::inline extreme {

/// The rounded inverse of the matrix of a simplex's corners, and its error bound:
/// docs/exactness.md, "Extreme points without facets".
class SimplexInverse {
 public:
  /// False where the simplex is too flat for doubles. Coordinates must be exact, |x| <= 1.
  bool set(const LocalPoints& points, const std::uint32_t* corners);
  /// Whether x is proved to be strictly inside.
  bool surely_inside(const double* x) const;

 private:
  unsigned rows_ = 0;
  std::vector<double> inverse_;  ///< rows_ x rows_: barycentric coordinates of (x, 1)
  std::vector<double> allowed_;  ///< rounding error of each
  /// 2 sum_i max_j |I - M A|_ij; infinite where there is no simplex.
  double rest_ = std::numeric_limits<double>::infinity();
};

}  // namespace cullhull::internal::inline extreme
