#include "few/small_polygon.hpp"

#include <algorithm>
#include <utility>

#include "geometry/gather.hpp"
#include "result/write/few_lists.hpp"

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
  rows_ = all_ ? packed_doubles(points) : filter_.rows();
  if (!all_finite(rows_, 2 * std::size_t{count_})) return false;
  const std::vector<std::uint32_t>& corners = series_.corners(rows_, count_);
  if (corners.size() < 3) return false;
  rank(corners);
  return true;
}

void SmallPolygon::rank(const std::vector<std::uint32_t>& corners) {
  const std::uint32_t rows = count_;
  const std::size_t h = corners.size();
  rank_.assign(rows, 0);
  for (const std::uint32_t row : corners) rank_[row] = 1;
  by_rank_.resize(h);
  std::uint32_t count = 0;
  for (std::uint32_t row = 0; row < rows; ++row) count += std::exchange(rank_[row], count);
  // Counter-clockwise from the lowest row.
  const auto lowest =
      static_cast<std::size_t>(std::min_element(corners.begin(), corners.end()) - corners.begin());
  cycle_.resize(h);
  for (std::size_t i = 0; i < h; ++i) {
    const std::uint32_t row = corners[lowest + i < h ? lowest + i : lowest + i - h];
    cycle_[i] = rank_[row];
    by_rank_[rank_[row]].id = all_ ? row : filter_.id(row);
    by_rank_[rank_[row]].row = row;
  }
  for (std::size_t i = 0; i < h; ++i) {
    by_rank_[cycle_[i]].before = cycle_[i == 0 ? h - 1 : i - 1];
    by_rank_[cycle_[i]].after = cycle_[i + 1 == h ? 0 : i + 1];
  }
}

bool SmallPolygon::measure(const PointView& set, double* planes, PlanarMeasures& measures) {
  const EdgeKernel kernel(series_.box());
  if (!kernel.ordinary()) return false;
  for (Corner& c : by_rank_)
    c.point = kernel.scaled({rows_[2 * std::size_t{c.row}], rows_[2 * std::size_t{c.row} + 1]});
  static_assert(PlaneFilter::most_kept <= row_of(Way::few_in_plane).most_left &&
                row_of(Way::few_in_plane).most_left <= measure_chunk);  // one chunk of sums
  Share<2, DoubleDouble> sums;
  const std::size_t h = by_rank_.size();
  Share<2> run;
  for (std::size_t i = 0; i < h; ++i) {
    Share<2> share;
    const Corner& c = by_rank_[i];
    if (!kernel.edge(c.point, by_rank_[c.before].point, by_rank_[0].point, planes + 3 * i, share))
      return false;
    run.add(share);
    if ((i + 1) % measure_run != 0 && i + 1 != h) continue;
    sums.add(run);
    run = {};
  }
  Share<2, DoubleDouble> all;
  all.add(sums);
  return finish_polygon(kernel, all, set, by_rank_[0].id, measures);
}

void SmallPolygon::write_vertices(std::uint64_t* vertices) const {
  for (std::size_t i = 0; i < cycle_.size(); ++i) vertices[i] = by_rank_[cycle_[i]].id;
}

template <class Target>
bool SmallPolygon::write(const PointView& set, Target& target) {
  const std::size_t h = size(), before = target.facet_planes.size();
  PlanarMeasures measures;
  target.facet_planes.resize(before + 3 * h);
  if (!measure(set, target.facet_planes.data() + before, measures)) {
    target.facet_planes.resize(before);
    return false;
  }
  write_measures(2, set.count, measures.volume, measures.area, measures.centroid, target);
  const auto two = [](std::size_t) { return 2; };
  write_lists(FewSizes{2, h, h, h, 2 * h}, target, two, [&](const FewLists& to) {
    write_vertices(to.vertices);
    for (std::size_t i = 0; i < h; ++i) {
      const Corner& c = by_rank_[i];
      to.simplices[2 * i] = to.facets[2 * i + 1] = c.id;
      to.simplices[2 * i + 1] = to.facets[2 * i] = by_rank_[c.before].id;
      to.simplex_neighbours[2 * i] = to.facet_neighbours[2 * i + 1] = c.before;
      to.simplex_neighbours[2 * i + 1] = to.facet_neighbours[2 * i] = c.after;
    }
  });
  return true;
}
template bool SmallPolygon::write(const PointView&, Hull&);
template bool SmallPolygon::write(const PointView&, HullBatch&);

}  // namespace cullhull::internal
