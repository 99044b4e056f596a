// The leaders among all points, in a loop over the CPU's kernels.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <vector>

#include "filter/gauge/gauge_frame.hpp"
#include "filter/gauge/gauge_table.hpp"

namespace cullhull::testing_support {

/// Of each cell of directions, `cells` along an edge, the row of the largest gauge by `map`.
template <unsigned D>
std::vector<std::uint64_t> outermost_of_cells(const internal::GaugeTable& map, unsigned cells,
                                              const std::vector<double>& rows) {
  const auto n = static_cast<std::uint32_t>(rows.size() / D);
  double low[D], high[D], centre[D], reach[D];
  std::fill_n(low, D, std::numeric_limits<double>::infinity());
  std::fill_n(high, D, -std::numeric_limits<double>::infinity());
  for (std::uint32_t i = 0; i < n; ++i) {
    const double* const x = &rows[std::size_t{i} * D];
    if (!std::all_of(x, x + D, [](double v) { return std::isfinite(v); })) continue;
    for (unsigned j = 0; j < D; ++j) {
      low[j] = std::min(low[j], x[j]);
      high[j] = std::max(high[j], x[j]);
    }
  }
  for (unsigned j = 0; j < D; ++j) {
    centre[j] = map.offset[j] / map.scale[j];
    reach[j] = std::max(high[j] - centre[j], centre[j] - low[j]);
  }
  internal::GaugeTable grid;
  grid.dimension = D;
  grid.cells = cells;
  internal::GaugeFrame<D> frame;
  if (!frame.set(centre, reach, true) || !frame.fill(grid)) return {};
  std::vector<float> gauges(n + internal::gauge_room);
  std::vector<std::uint32_t> corners(n + internal::gauge_room);
  internal::gauge_bounds(map, rows.data(), n, gauges.data());
  internal::gauge_corners(grid, rows.data(), n, corners.data());
  std::map<std::uint32_t, std::uint32_t> best;
  for (std::uint32_t i = 0; i < n; ++i) {
    if (!(gauges[i] > 0 && std::isfinite(gauges[i]))) continue;
    const auto [at, first] = best.emplace(corners[i], i);
    if (!first && gauges[i] > gauges[at->second]) at->second = i;
  }
  std::vector<std::uint64_t> ids;
  for (const auto& [cell, i] : best) ids.push_back(i);
  return ids;
}

}  // namespace cullhull::testing_support
