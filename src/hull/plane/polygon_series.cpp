// Polygons of small sets: a single bucket each; inner points are dropped before sorting.
#include "hull/plane/polygon.hpp"
#include "hull/plane/quadrilateral.hpp"

namespace cullhull::internal::inline hull {
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
  const Quadrilateral middle({&chord.first, &lowest, &chord.last, &highest}, box_);
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

}  // namespace cullhull::internal::inline hull
