// Drops points of the plane in one or two passes, without a map: where one coordinate has few whole
// values, all but the ends of each column; else what is inside an ellipse in the hull of a sample.
#pragma once

#include <cstdint>
#include <vector>

#include "cullhull/point_view.hpp"
#include "filter/inner_ellipse.hpp"
#include "filter/ways.hpp"
#include "geometry/gather.hpp"

namespace cullhull::internal {

/// The points that may be corners of a set's hull. Reuses its memory from set to set: at most 300
/// KB.
class PlaneFilter {
 public:
  /// The most points that it keeps. Where samples leave more, of a square of 26,000 points, a map
  /// is as fast.
  static constexpr std::uint32_t most_kept = 5632;

  /// Filters less than 2^32 points of the plane. `hull` finds the corners of samples: its
  /// corners(rows, count), counter-clockwise, of finite packed pairs, and then their box(). False
  /// where this does not pay or too much is left; the members below then say nothing.
  ///
  /// With less than 192 points a sample costs more than it saves: 12 % more time at 130 and 160
  /// points in a disc. At 200 and 250 points it saves 12 to 16 % in discs and 10 to 13 % in
  /// Gaussian sets, and costs 7 to 8 % on circles.
  ///
  /// The first sample has at most `first_sample` points, at least an eighth of that. What a map
  /// leaves of a disc is a thin ring: nearly all points of a small sample of it are extreme.
  template <class Hull>
  bool keep_few(const PointView& set, Hull& hull, std::uint64_t first_sample = 191) {
    const WayQuestion q{.dimension = 2, .count = set.count, .left = true};
    if (takes(Way::columns, q) && keep_ends_of_columns(set)) return kept_by(Way::columns);
    return takes(Way::ellipse, q) && keep_outside_samples(set, hull, first_sample) &&
           kept_by(Way::ellipse);
  }

  /// The way that kept them.
  Way way() const { return way_; }
  std::uint32_t count() const { return count_; }
  /// The numbers of the count() kept points in the set of the last keep_few(), ascending.
  const std::uint32_t* ids() const { return kept_.data(); }
  /// The kept points' coordinates: packed pairs, with the sign of each zero. They may not be
  /// finite.
  const double* rows() const { return rows_.data(); }

 private:
  struct Column {
    double least, most;         ///< on the other axis
    std::uint32_t first, last;  ///< the points that have them
  };

  bool kept_by(Way way) {
    way_ = way;
    return true;
  }
  bool keep_ends_of_columns(const PointView& set);
  void find_ends(const PointView& set, unsigned axis, double low, std::uint32_t columns);
  void make_room();
  void keep_all(const PointView& set, std::uint64_t step);
  void keep_outside(const PointView& set, std::uint64_t step, const InnerEllipse& ellipse);
  bool may_leave_few(const InnerEllipse& ellipse, std::uint64_t step, std::uint64_t ratio,
                     double& before);

  /// Discards inner points by samples of every 8th, 64th, ... point: the hull of the smallest
  /// sample thins the next larger one, and so on, so that all samples but the largest take little
  /// time.
  template <class Hull>
  bool keep_outside_samples(const PointView& set, Hull& hull, std::uint64_t first_sample) {
    // Each sample takes an eighth of the time of the next.
    constexpr std::uint64_t ratio = 8;
    std::uint64_t step = ratio;
    while (set.count / step > first_sample) step *= ratio;
    keep_all(set, step);
    for (double before = 0;;) {
      if (!all_finite(rows(), 2 * std::size_t{count_})) return false;
      const std::vector<std::uint32_t>& corners = hull.corners(rows(), count_);
      // Efron 1965: the share of the points outside a sample's hull is about the share of the
      // sample that is extreme. A third is too much, but of the first sample of 25 points in a disc
      // 10 are extreme: there two thirds are.
      const std::uint64_t most = set.count / step * (before == 0 ? 2 : 1) / 3;
      if (corners.size() < 3 || corners.size() > most) return false;
      const InnerEllipse ellipse(rows(), corners, hull.box());
      if (step > ratio && !may_leave_few(ellipse, step, ratio, before)) return false;
      step /= ratio;
      keep_outside(set, step, ellipse);
      if (count_ > most_kept) return false;
      if (step == 1) return true;
    }
  }

  Way way_ = Way::columns;
  std::uint32_t count_ = 0;
  std::vector<std::uint32_t> kept_, outside_;
  std::vector<double> rows_;
  std::vector<Column> columns_;
};

}  // namespace cullhull::internal
