#include "batch/planar_sets.hpp"

#include <algorithm>
#include <cmath>

namespace cullhull::internal {
namespace {

/// Beyond it a filter may pay.
constexpr std::uint64_t most_points = 4096;

/// Items [from, size) are new.
template <class Vector>
auto* extend(Vector& to, std::size_t count) {
  const std::size_t size = to.size();
  to.resize(size + count);
  return to.data() + size;
}

template <class T>
void end_list(Lists<T>& lists) {
  lists.offsets.push_back(lists.items.size());
}

}  // namespace

PlanarSets::PlanarSets(const Control& control) : series_(control) {}

bool PlanarSets::append(const PointView& set, HullBatch& to) {
  if (set.dimension != 2 || set.count < 3 || set.count > most_points) return false;
  const auto n = static_cast<std::uint32_t>(set.count);
  const double* const rows = load(set);
  double sum = 0;  // x * 0 is NaN exactly for NaN and infinities
  for (std::uint32_t i = 0; i < 2 * n; ++i) sum += rows[i] * 0.0;
  if (sum != 0) return false;
  const std::vector<std::uint32_t>& corners = series_.corners(rows, n);
  if (corners.size() < 3) return false;
  const EdgeKernel kernel(series_.box());
  if (!kernel.ordinary()) return false;
  rank(corners, n);
  for (Corner& c : by_rank_)
    c.point = kernel.scaled({rows[2 * std::size_t{c.row}], rows[2 * std::size_t{c.row} + 1]});
  const std::size_t planes = to.facet_planes.size();
  Hull measures;
  if (!measure(set, kernel, extend(to.facet_planes, 3 * by_rank_.size()), measures)) {
    to.facet_planes.resize(planes);
    return false;
  }
  write(set, measures, to);
  return true;
}

/// Coordinates as they are given, a negative zero too.
const double* PlanarSets::load(const PointView& set) {
  const auto address = reinterpret_cast<std::uintptr_t>(set.data);
  if (set.scalar == ScalarType::f64 && set.packed_rows() && address % alignof(double) == 0)
    return reinterpret_cast<const double*>(set.data);
  if (rows_.size() < 2 * set.count) rows_.resize(2 * set.count);
  for (std::uint64_t i = 0; i < set.count; ++i)
    for (unsigned j = 0; j < 2; ++j) rows_[2 * i + j] = set.at(i, j);
  return rows_.data();
}

void PlanarSets::rank(const std::vector<std::uint32_t>& corners, std::uint32_t rows) {
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

bool PlanarSets::measure(const PointView& set, const EdgeKernel& kernel, double* planes,
                         Hull& measures) {
  Totals<DoubleDouble> sums(2);
  const std::size_t h = by_rank_.size();
  static_assert(most_points <= measure_chunk);  // one chunk of sums
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
  Totals<DoubleDouble> all(2);
  all.add(sums);
  return finish_polygon(kernel, all, set, by_rank_[0].row, measures);
}

void PlanarSets::write(const PointView& set, const Hull& measures, HullBatch& to) const {
  const std::size_t h = by_rank_.size();
  to.point_counts.push_back(set.count);
  to.affine_dimensions.push_back(2);
  to.volumes.push_back(measures.volume);
  to.areas.push_back(measures.area);
  to.centroids.insert(to.centroids.end(), measures.centroid.begin(), measures.centroid.end());
  std::uint64_t* const vertices = extend(to.vertices.items, h);
  for (std::size_t i = 0; i < h; ++i) vertices[i] = by_rank_[cycle_[i]].row;
  end_list(to.vertices);

  to.facet_starts.push_back(to.facet_starts.back() + h);
  std::uint64_t facets_at = to.facets.items.size(), across_at = to.facet_neighbours.items.size();
  for (std::size_t i = 0; i < h; ++i) {
    to.facets.offsets.push_back(facets_at += 2);
    to.facet_neighbours.offsets.push_back(across_at += 2);
  }
  std::uint64_t* const facets = extend(to.facets.items, 2 * h);
  std::uint64_t* const simplices = extend(to.simplices.items, 2 * h);
  std::uint32_t* const across = extend(to.facet_neighbours.items, 2 * h);
  std::uint32_t* const next = extend(to.simplex_neighbours.items, 2 * h);
  std::uint32_t* const number = extend(to.simplex_facets.items, h);
  for (std::size_t i = 0; i < h; ++i) {
    const Corner& c = by_rank_[i];
    simplices[2 * i] = facets[2 * i + 1] = c.row;
    simplices[2 * i + 1] = facets[2 * i] = by_rank_[c.before].row;
    next[2 * i] = across[2 * i + 1] = c.before;
    next[2 * i + 1] = across[2 * i] = c.after;
    number[i] = static_cast<std::uint32_t>(i);
  }
  end_list(to.simplices);
  end_list(to.simplex_neighbours);
  end_list(to.simplex_facets);
}

}  // namespace cullhull::internal
