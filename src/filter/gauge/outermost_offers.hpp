// The leaders of cells of directions (gauge_leaders.cpp) among all points, over any executor: of
// each cell the point that a map finds outermost. Few rows are left of any number of points, of
// which the CPU makes the next map.
#pragma once

#include <algorithm>
#include <cstdint>

#include "filter/gauge/gauge_frame.hpp"
#include "filter/gauge/gauge_lanes.hpp"
#include "filter/pseudo_hull/primitives.hpp"
#include "filter/pseudo_hull/pseudo_hull_start.hpp"

namespace cullhull::internal {

/// Offers each row to its cell: the bits of its gauge above those of the row, so that of equal ones
/// the lowest row wins. A row that is not finite makes no offer, nor does the centre.
template <unsigned D, class C, class Rows>
struct OfferOutermost {
  Rows rows;
  GaugeConstants<D, C> map, cells;
  const float* nodes;  ///< the map's

  CULLHULL_HD Offer operator()(std::uint32_t i) const {
    double x[D];
    rows.load(i, x);
    const GaugePlace<D> at = place(map, x);
    const float gauge = gauge_bound(map, nodes, at);
    if (!(gauge > 0)) return {no_item, 0};  // also for NaN
    return {place(cells, x).corner, std::uint64_t{lanes::bits_of(gauge)} << 32 | (no_item - i)};
  }

 private:
  CULLHULL_HD static GaugePlace<D> place(const GaugeConstants<D, C>& t, const double* x) {
    float y[D];
    for (unsigned j = 0; j < D; ++j)
      y[j] = lanes::centred(static_cast<C>(x[j]), t.scale[j], t.offset[j]);
    return gauge_place(t, y);
  }
};

struct HasLeader {
  const std::uint64_t* best;
  CULLHULL_HD bool operator()(std::uint32_t cell) const { return best[cell] != 0; }
};
struct EmitLeader {
  const std::uint64_t* best;
  std::uint64_t* ids;
  CULLHULL_HD void operator()(std::uint32_t cell, std::uint32_t k) const {
    ids[k] = no_item - static_cast<std::uint32_t>(best[cell]);
  }
};

/// Cells of directions without nodes, so many along an edge: around the map's centre, in the frame
/// that the map of the rows' leaders will have. False if there is none.
template <unsigned D, class Executor, class Rows>
bool leader_cells(Executor& executor, const Rows& rows, std::uint32_t count, const GaugeTable& map,
                  unsigned cells, GaugeTable& grid) {
  const AxisExtremes<D> e = extremes_of<D>(executor, rows, count).get();
  double centre[D], reach[D];
  for (unsigned j = 0; j < D; ++j) {
    centre[j] = map.offset[j] / map.scale[j];
    reach[j] = std::max(e.high[j] - centre[j], centre[j] - e.low[j]);
  }
  grid.dimension = D;
  grid.cells = cells;
  GaugeFrame<D> frame;
  return frame.set(centre, reach, true) && frame.fill(grid);
}

/// Writes the leaders' rows in the order of their cells, and returns how many there are. `best` and
/// `ids` have room for all corners of the cells.
template <class Executor, class Offers>
std::uint32_t list_outermost(Executor& executor, const Offers& offer, std::uint32_t count,
                             std::uint32_t corners, std::uint64_t* best, std::uint64_t* ids) {
  executor.scatter_max(count, corners, offer, best);
  return executor.select(corners, HasLeader{best}, EmitLeader{best, ids});
}

}  // namespace cullhull::internal
