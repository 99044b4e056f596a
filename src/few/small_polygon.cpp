#include "few/small_polygon.hpp"

#include <algorithm>

#include "geometry/gather.hpp"

namespace cullhull::internal {

bool SmallPolygon::find(const PointView& set) {
  if (!takes(Way::few_in_plane, {.dimension = set.dimension, .count = set.count})) return false;
  // Of these a copy is made where that is needed, once for all passes.
  constexpr std::uint64_t most_copied = std::uint64_t{1} << 16;
  const PointView points = set.count <= most_copied
                               ? PointView::row_major(rows_as_given(set, loaded_), set.count, 2)
                               : set;
  all_ = !filter_.keep_few(points, series_);
  if (all_ && set.count > row_of(Way::few_in_plane).most_left) return false;
  count_ = all_ ? static_cast<std::uint32_t>(set.count) : filter_.count();
  const double* const rows = all_ ? packed_doubles(points) : filter_.rows();
  if (!all_finite(rows, 2 * std::size_t{count_})) return false;
  corners_ = &series_.corners(rows, count_, !all_);
  return corners_->size() >= 3;
}

std::vector<std::uint64_t> SmallPolygon::extreme() const {
  std::vector<std::uint64_t> extreme(corners_->begin(), corners_->end());
  if (!all_)
    for (std::uint64_t& id : extreme) id = filter_.ids()[id];
  std::sort(extreme.begin(), extreme.end());
  return extreme;
}

}  // namespace cullhull::internal
