// Discards points inside the hull of a sample or inside the quadrilateral of four corners, before
// the others are sorted.
#pragma once

#include <cmath>
#include <vector>

#include "hull/plane/planar.hpp"
#include "parallel/threads/run.hpp"

namespace cullhull::internal {

/// Smallest and largest coordinates.
struct Box {
  double low[2], high[2];
};

/// The four outermost points, of equal ones the lowest row: first and last by x, then y; first and
/// last by y, then x. All are extreme.
class Corners {
 public:
  /// Rows must ascend.
  void add(const Entry& e) {
    if (none_) at_[0] = at_[1] = at_[2] = at_[3] = e;
    none_ = false;
    if (by_x(e, at_[0])) at_[0] = e;
    if (by_y(e, at_[1])) at_[1] = e;
    if (by_x(at_[2], e)) at_[2] = e;
    if (by_y(at_[3], e)) at_[3] = e;
  }
  void add(const Corners& more) {
    for (unsigned i = 0; i < 4 && !more.none_; ++i) add(more.at_[i]);
  }
  const Entry& first() const { return at_[0]; }
  const Entry& last() const { return at_[2]; }
  /// Counter-clockwise; some may coincide.
  const Entry& operator[](unsigned i) const { return at_[i]; }

 private:
  static bool by_x(const Entry& a, const Entry& b) {
    return a.x < b.x || (a.x == b.x && a.y < b.y);
  }
  static bool by_y(const Entry& a, const Entry& b) {
    return a.y < b.y || (a.y == b.y && a.x < b.x);
  }
  bool none_ = true;
  Entry at_[4];
};

/// The area between two chains of hull points, over buckets of x: a point of bucket i with
/// floor[i] < y < ceiling[i] is in their hull and no vertex of it.
///
/// Coordinates are mapped to u = fl((x - low) 2^-e), e such that 0 <= u <= 1 and the largest u is
/// at least 1/2: off the affine image by 2^-53 at most, one rounding of a difference. So a chain of
/// rounded points is within 2^-53 (in u and in v) of the image of the chain, which is convex.
class Strip {
 public:
  static constexpr unsigned buckets = 1024;

  /// False if the points are too few or of a range that the bounds below do not cover.
  bool build(const Box& box, const std::vector<Entry>& lower, const std::vector<Entry>& upper);

  bool contains(double x, double y) const {
    const double u = (x - low_[0]) * scale_[0], v = (y - low_[1]) * scale_[1];
    const double t = (u - left_) * per_unit_;
    const Cell& c = cells_[static_cast<int>(t < 0 ? 0.0 : t < buckets - 1.0 ? t : buckets - 1.0)];
    // Rounding is monotone, so what is strictly between the rounded ends is strictly between the
    // ends.
    return (u > left_) & (u < right_) & (v > c.floor) & (v < c.ceiling);
  }

 private:
  struct Cell {
    double floor, ceiling;
  };
  struct Corner {
    double u, v;
  };
  std::vector<Corner> gather(const std::vector<Entry>& chain) const;
  static double height(const std::vector<Corner>& chain, std::size_t& from, double u);

  double low_[2] = {0, 0}, scale_[2] = {0, 0};
  double left_ = 0, right_ = 0, per_unit_ = 0;
  Cell cells_[buckets];
};

/// Rows that may be extreme, ascending; empty where a sample shows that discarding does not pay.
std::vector<std::uint32_t> discard_inner(const PlanarSource& source, const Box& box,
                                         const Corners& corners, const Run& run);

// Discards points inside the quadrilateral of four corners of the hull.

/// The quadrilateral of four outermost points (Akl and Toussaint 1978) as linear functions of (x,
/// y) - origin, which exceed their limits inside. Not all four may be equal. In small sets, which
/// use no strip, it saves a sixth of a hull's time (100 points) or a twentieth (1000 points).
class Quadrilateral {
 public:
  Quadrilateral(const Entry* const (&corners)[4], const Box& box)
      : x_(corners[0]->x), y_(corners[0]->y) {
    const double width = box.high[0] - box.low[0], height = box.high[1] - box.low[1];
    for (unsigned i = 0; i < 4; ++i) {
      const Entry &a = *corners[i], &b = *corners[(i + 1) % 4];
      if (equal(a, b)) continue;  // no edge: 0 > -1 always holds
      nx_[i] = a.y - b.y;
      ny_[i] = b.x - a.x;
      // With u = 2^-53 and S = |nx| width + |ny| height, which bounds all terms' sums: f and the
      // offset have four roundings a term, the comparison's right side one, so 10 u S covers their
      // errors and 16 u S those of S too. Underflow is below the second term; overflow makes the
      // limit infinite or a NaN, and no point counts as inside.
      const double sum = std::fabs(nx_[i]) * width + std::fabs(ny_[i]) * height;
      limit_[i] = nx_[i] * (a.x - x_) + ny_[i] * (a.y - y_) + (0x1p-49 * sum + 0x1p-1060);
    }
  }
  /// True only for points strictly inside.
  bool contains(double x, double y) const {
    const double dx = x - x_, dy = y - y_;
    bool inside = true;
    for (unsigned i = 0; i < 4; ++i) inside &= nx_[i] * dx + ny_[i] * dy > limit_[i];
    return inside;
  }

 private:
  double x_, y_;
  double nx_[4] = {}, ny_[4] = {}, limit_[4] = {-1, -1, -1, -1};
};

}  // namespace cullhull::internal
