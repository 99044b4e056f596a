// Whether a point is in the convex hull of others, without the hull: linear programming, in
// floating point with exactly checked certificates, else in rational numbers.
#pragma once

#include <cstdint>
#include <vector>

#include "control.hpp"
#include "points/local_points.hpp"

namespace cullhull::internal {

/// Tests points of one set against the others. Not thread safe; each worker has its own.
class HullMembership {
 public:
  HullMembership(const LocalPoints& points, const Control& control);

  /// Whether `point` is in the hull of the points `others` without itself. No other may equal it.
  /// `working`: some of `others`, ascending or not, tried first; points that proved useful are
  /// appended to `useful`.
  bool inside(std::uint32_t point, const std::vector<std::uint32_t>& others,
              const std::vector<std::uint32_t>& working, std::vector<std::uint32_t>& useful);

  /// Points that floating point could not decide.
  std::uint64_t exact_count() const { return exact_count_; }

 private:
  enum class Answer { inside, separated, unknown };
  Answer approach(std::uint32_t point, const std::vector<std::uint32_t>& working,
                  const std::vector<std::uint32_t>& useful);
  bool nearest_in_flat();
  void move_to_nearest();
  void combine();
  void add(std::uint32_t q);
  std::uint32_t most_against(const std::vector<std::uint32_t>& ids, std::uint32_t point,
                             double& least) const;
  bool certain_inside(std::uint32_t point) const;
  int side_of(std::uint32_t point, std::uint32_t q) const;

  const LocalPoints& points_;
  const Control& control_;
  const unsigned d_;
  const double* origin_ = nullptr;
  std::vector<std::uint32_t> corral_;
  std::vector<double> weights_, flat_, direction_, system_;
  std::uint64_t exact_count_ = 0;
};

/// The same by Bland's rule over the rationals: always right, slow.
bool inside_exact(const LocalPoints& points, std::uint32_t point,
                  const std::vector<std::uint32_t>& others, const Control& control);

}  // namespace cullhull::internal
