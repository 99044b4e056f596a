// Polygons of small sets: one bucket each, what is inside dropped before it is sorted.
#include <algorithm>
#include <cmath>

#include "hull/plane/polygon.hpp"

namespace cullhull::internal {
namespace {

/// The quadrilateral of four outermost points (Akl and Toussaint 1978) as linear functions of
/// (x, y) - origin, above their limits inside. Not all four may be equal.
class Middle {
 public:
  Middle(const Entry* const (&corners)[4], const Box& box) : x_(corners[0]->x), y_(corners[0]->y) {
    const double width = box.high[0] - box.low[0], height = box.high[1] - box.low[1];
    for (unsigned i = 0; i < 4; ++i) {
      const Entry &a = *corners[i], &b = *corners[(i + 1) % 4];
      if (equal(a, b)) continue;  // no edge: 0 > -1
      nx_[i] = a.y - b.y;
      ny_[i] = b.x - a.x;
      // With u = 2^-53 and S = |nx| width + |ny| height, which bounds all terms' sums: f and the
      // offset have four roundings a term, the comparison's right side one, so 10 u S covers their
      // errors and 16 u S those of S too. What underflows is below the second term; what overflows
      // makes the limit infinite or a NaN, and nothing is inside.
      const double sum = std::fabs(nx_[i]) * width + std::fabs(ny_[i]) * height;
      limit_[i] = nx_[i] * (a.x - x_) + ny_[i] * (a.y - y_) + (0x1p-49 * sum + 0x1p-1060);
    }
  }
  /// Certainly strictly inside.
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

}  // namespace

PolygonSeries::PolygonSeries(const Control& control) : chains_({}, Turn(), control) {}

const std::vector<std::uint32_t>& PolygonSeries::corners(const double* rows, std::uint32_t count) {
  const auto entry = [rows](std::uint32_t i) {
    return Entry{rows[2 * std::size_t{i}], rows[2 * std::size_t{i} + 1], i, 0};
  };
  Chord chord{entry(0), entry(0)};
  Entry lowest = chord.first, highest = lowest;
  for (std::uint32_t i = 1; i < count; ++i) {
    const Entry e = entry(i);
    if (e.y < lowest.y) lowest = e;
    if (e.y > highest.y) highest = e;
    if (before(e, chord.first)) chord.first = e;
    if (before(chord.last, e)) chord.last = e;
  }
  box_ = {{chord.first.x, lowest.y}, {chord.last.x, highest.y}};
  corners_.clear();
  if (equal(chord.first, chord.last)) {
    corners_.push_back(0);
    return corners_;
  }
  const KeyMap map(chord.first.x, chord.last.x);
  const Middle middle({&chord.first, &lowest, &chord.last, &highest}, box_);
  if (entries_.size() < count) entries_.resize(std::size_t{2} * count);
  Entry* const e = entries_.data();
  std::uint32_t kept = 0;
  for (std::uint32_t i = 0; i < count; ++i) {
    const double x = rows[2 * std::size_t{i}], y = rows[2 * std::size_t{i} + 1];
    e[kept] = {x, y, i, map.key(x)};
    kept += !middle.contains(x, y);
  }
  chains_.restart(chord);
  chains_.add(e, kept, 32);
  for (std::uint32_t i = 0; i + 1 < chains_.lower_count(); ++i)
    corners_.push_back(chains_.lower()[i].row);
  for (std::uint32_t i = chains_.upper_count() - 1; i > 0; --i)
    corners_.push_back(chains_.upper()[i].row);
  return corners_;
}

}  // namespace cullhull::internal
