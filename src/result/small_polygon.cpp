#include "result/small_polygon.hpp"

#include <algorithm>
#include <utility>

namespace cullhull::internal {
namespace {

bool finite(const double* values, std::uint32_t count) {
  double sum[4] = {};  // x * 0 is NaN exactly for NaN and infinities
  std::uint32_t i = 0;
  for (; i + 4 <= count; i += 4)
    for (unsigned j = 0; j < 4; ++j) sum[j] += values[i + j] * 0.0;
  for (; i < count; ++i) sum[0] += values[i] * 0.0;
  return sum[0] + sum[1] + sum[2] + sum[3] == 0;
}

}  // namespace

bool SmallPolygon::find(const PointView& set) {
  if (set.dimension != 2 || set.count < 3 || set.count > most_points) return false;
  const auto n = static_cast<std::uint32_t>(set.count);
  rows_ = load(set);
  if (!finite(rows_, 2 * n)) return false;
  const std::vector<std::uint32_t>& corners = series_.corners(rows_, n);
  if (corners.size() < 3) return false;
  rank(corners, n);
  return true;
}

/// Coordinates as they are given, a negative zero too.
const double* SmallPolygon::load(const PointView& set) {
  const auto address = reinterpret_cast<std::uintptr_t>(set.data);
  if (set.scalar == ScalarType::f64 && set.packed_rows() && address % alignof(double) == 0)
    return reinterpret_cast<const double*>(set.data);
  if (loaded_.size() < 2 * set.count) loaded_.resize(2 * set.count);
  load_rows(set, 0, set.count, loaded_.data());
  return loaded_.data();
}

void SmallPolygon::rank(const std::vector<std::uint32_t>& corners, std::uint32_t rows) {
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
  static_assert(most_points <= measure_chunk);  // one chunk of sums
  PolygonSums sums;
  const std::size_t h = by_rank_.size();
  EdgeShare run;
  for (std::size_t i = 0; i < h; ++i) {
    EdgeShare share;
    const Corner& c = by_rank_[i];
    if (!kernel.edge(c.point, by_rank_[c.before].point, by_rank_[0].point, planes + 3 * i, share))
      return false;
    run.add(share);
    if ((i + 1) % measure_run != 0 && i + 1 != h) continue;
    run.add_to(sums);
    run = {};
  }
  PolygonSums all;
  all.add(sums);
  return finish_polygon(kernel, all, set, by_rank_[0].row, measures);
}

void SmallPolygon::write_vertices(std::uint64_t* vertices) const {
  for (std::size_t i = 0; i < cycle_.size(); ++i) vertices[i] = by_rank_[cycle_[i]].row;
}

void SmallPolygon::write_lists(std::uint64_t* simplices, std::uint32_t* simplex_neighbours,
                               std::uint64_t* facets, std::uint32_t* facet_neighbours) const {
  for (std::size_t i = 0; i < by_rank_.size(); ++i) {
    const Corner& c = by_rank_[i];
    simplices[2 * i] = facets[2 * i + 1] = c.row;
    simplices[2 * i + 1] = facets[2 * i] = by_rank_[c.before].row;
    simplex_neighbours[2 * i] = facet_neighbours[2 * i + 1] = c.before;
    simplex_neighbours[2 * i + 1] = facet_neighbours[2 * i] = c.after;
  }
}

}  // namespace cullhull::internal
