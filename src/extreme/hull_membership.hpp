// Decides whether a point is in the convex hull of others, without building the hull: by linear
// programming, in floating point with exactly checked certificates, else in rational arithmetic.
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
  /// Returns false if the simplex is too flat for doubles. Coordinates must be exact, |x| <= 1.
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
