// A k-d tree for the nearest of some points, exactly: doubles with a bound choose the candidates,
// exact arithmetic decides between them.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "cullhull/point_view.hpp"

namespace binding {

/// All coordinates of a view as doubles, point after point.
std::vector<double> rows_of_view(const cullhull::PointView& view);

/// Points in a k-d tree. It copies what it needs; const members may be called from any thread.
class NearestTree {
 public:
  /// The most dimensions it takes: with more, a tree visits most of its leaves.
  static constexpr unsigned most_dimensions = 8;

  /// Whether a tree can be asked about these points: finite, in 1 to most_dimensions dimensions, no
  /// coordinate beyond 2^400 (then no square overflows).
  static bool takes(const cullhull::PointView& points, const std::vector<double>& rows);
  /// Whether it can hold them: the same, and some coordinate is at least 2^-400, unless all are
  /// zero. The squares of smaller ones vanish, so doubles would decide nothing.
  static bool holds(const cullhull::PointView& points, const std::vector<double>& rows);

  /// `rows`: the coordinates of `points`, of which there are fewer than 2^32 and at least one;
  /// holds(points, rows).
  NearestTree(const cullhull::PointView& points, const std::vector<double>& rows);
  ~NearestTree();

  unsigned dimension() const noexcept { return dimension_; }

  /// Writes for each query the index of the nearest point; of several the lowest. `rows`: `count`
  /// queries that takes() accepts. `check` is called with the completed share on the calling
  /// thread, every millisecond or so, and may throw. `threads`: the most threads to use.
  void nearest(const double* rows, std::uint64_t count, std::uint32_t* out, unsigned threads,
               const std::function<void(double)>& check) const;

  /// The tree for a dimension.
  class Base;

 private:
  unsigned dimension_;
  std::unique_ptr<const Base> tree_;
};

}  // namespace binding
