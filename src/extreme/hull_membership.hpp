// Decides whether a point is in the convex hull of others, without building the hull: by linear
// programming, in floating point with exactly checked certificates, else in rational arithmetic.
//
// Inside: p is a convex combination of the corral. Corners q of a simplex make the columns (q, 1)
// of a matrix A; M is its inverse, as computed. Let R = I - M A, b = (p, 1), A lambda = b: then
// lambda = M b + R lambda. Coordinates are off by at most r, 0 but for images of nearly flat sets.
// With n = d + 1 and S_i = Sum_j |M_ij| each entry of R is computed within ((n + 6) u + r) S_i + (n
// + 4) u, as |A| <= 1; so rho = Sum_i (max_j |R~_ij| + that) bounds the 1-norm of R. If rho <
// 2^-11, A is not singular, |lambda|_1 <= |M b|_1 / (1 - rho), and |lambda_i - (M b)_i| <= rho
// |lambda|_1 <= 2 rho |M b|_1. The computed mu is off from M b by at most ((n + 1) u + r) S_i. So
// mu_i - ((n + 6) u + r) S_i > 1.0625 * 2 rho (|mu|_1 + 1) for all i proves all lambda_i > 0: p is
// strictly inside. Where that fails: exact orientations of the corral's simplex with p in each
// corner's place, or a rational solution without a negative weight.
//
// Extreme: w*(q - p) > 0 for every other q. In f32 first, w being the direction rounded to f32: a
// coordinate rounded once, d products and sums, so each term carries at most d + 1 factors 1 +
// 2^-24 and w*q is within (d + 2) 2^-24 Sum |w_j| + 2^-120 (fused or not); w*p is computed in
// double. If the least computed w*q exceeds it by (d + 3) 2^-24 Sum |w_j| + 2^-120, all are beyond.
// Boxes change nothing: a box's bound comes from the same rounded operations at the corner that is
// least along w, and rounded products and sums are monotone, so it is at most every computed value
// of its block. Else in double: w*q and w*p are each off by at most gamma_d Sum |w_j|, so
// differences beyond ((2 d + 6) u + 2 r) Sum |w_j| + 2^-1000 are certain, the others are computed
// exactly (not in images). In f32 the 2^-24 to spare covers r.
// Where neither is proved, Bland's rule over the rationals decides; it always ends.
#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "exact/points/local_points.hpp"
#include "extreme/point_columns.hpp"
#include "parallel/threads/parallel.hpp"

namespace cullhull::internal {

/// The rounded inverse of the matrix of a simplex's corners, and its error bound:
/// docs/exactness.md, "Extreme points without facets".
class SimplexInverse {
 public:
  /// Returns false if the simplex is too flat for doubles. Requires |x| <= 1.
  bool set(const LocalPoints& points, const std::uint32_t* corners);
  /// Whether x is provably strictly inside.
  bool surely_inside(const double* x) const;

 private:
  unsigned rows_ = 0;
  std::vector<double> inverse_;  ///< rows_ x rows_: barycentric coordinates of (x, 1)
  std::vector<double> allowed_;  ///< rounding error of each coordinate
  /// 2 sum_i max_j |I - M A|_ij; infinite if there is no simplex.
  double rest_ = std::numeric_limits<double>::infinity();
};

/// Tests points of one set against the others. Not thread safe; each worker needs its own object.
class HullMembership {
 public:
  HullMembership(const LocalPoints& points, const Control& control);

  /// Whether `point` is in the hull of the other points of `others`, none of which may equal it.
  /// `working`: some of `others`, tried first; further points that were needed are appended to
  /// `useful`. A point near the previous one is tested faster.
  bool inside(std::uint32_t point, const PointColumns& others, const PointColumns& working,
              std::vector<std::uint32_t>& useful);

 private:
  enum class Answer { inside, separated, unknown };
  struct Farthest {
    std::uint32_t id = no_index;
    double least = 0;  ///< direction_ . (id - point)
  };
  Answer search(std::uint32_t point, const PointColumns& others, const PointColumns& working,
                std::vector<std::uint32_t>& useful);
  Answer approach(std::uint32_t point, const PointColumns& working,
                  const std::vector<std::uint32_t>& useful);
  Answer separates_all(std::uint32_t point, const PointColumns& others, std::uint32_t& against);
  bool in_known_simplex(std::uint32_t point) const;
  bool prove_inside(std::uint32_t point);
  void begin_with_last(std::uint32_t point);
  void narrow_direction();
  bool in_corral(std::uint32_t q) const;
  bool nearest_in_flat();
  void move_to_nearest();
  void combine();
  void add(std::uint32_t q);
  Farthest most_against(const std::vector<std::uint32_t>& ids, std::uint32_t point) const;
  Farthest roughly_most_against(const PointColumns& points, std::uint32_t point, std::size_t count);
  double against(std::uint32_t q) const;
  bool certain_inside(std::uint32_t point) const;
  int side_of(std::uint32_t point, std::uint32_t q) const;

  const LocalPoints& points_;
  const Control& control_;
  const unsigned d_;
  const double* origin_ = nullptr;
  std::vector<std::uint32_t> corral_;
  std::vector<double> weights_, flat_, direction_, system_;
  std::vector<float> narrow_;  ///< direction_ scaled so that its largest coordinate is 1
  static constexpr unsigned most_simplices = 8;
  std::vector<SimplexInverse> simplices_;  ///< simplices that contained recent points
  unsigned newest_ = 0;
};

/// Decides the same by the simplex method with Bland's rule in rational arithmetic: never fails,
/// slow.
bool inside_exact(const LocalPoints& points, std::uint32_t point,
                  const std::vector<std::uint32_t>& others, const Control& control);

}  // namespace cullhull::internal
