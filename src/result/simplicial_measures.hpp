// What both ways to a simplicial result end with: area, volume and centroid.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "parallel/big_array.hpp"
#include "parallel/control.hpp"
#include "parallel/parallel.hpp"
#include "result/build_hull.hpp"
#include "result/facet_share.hpp"
#include "result/measure.hpp"
#include "result/measure_frame.hpp"
#include "result/surface.hpp"

namespace cullhull::internal {

/// From the sums over runs of facets, or afresh where those have lost too much: the hull is thin.
/// `vertices`: their ids, ascending; hull.simplices are in place.
template <unsigned K>
void finish_simplicial(const ResultInput& input, const std::vector<std::uint64_t>& vertices,
                       const Frame& frame, const Share<K>* runs, unsigned threads,
                       const Control& control, Hull& hull) {
  const std::uint64_t count = hull.simplices.size() / K;
  const Totals<DoubleDouble> all = total_of_runs(runs, chunk_count(count, measure_run), threads);
  if (settled(all, 0x1p-53)) return finish_measures(frame, all, hull);
  std::vector<std::uint32_t> index;
  resize_big(index, count * K);
  for_each_chunk(index.size(), simplex_chunk, threads,
                 [&](std::uint64_t, std::uint64_t begin, std::uint64_t end) {
                   control.check();
                   for (std::uint64_t i = begin; i < end; ++i)
                     index[i] = static_cast<std::uint32_t>(
                         std::lower_bound(vertices.begin(), vertices.end(), hull.simplices[i]) -
                         vertices.begin());
                 });
  measure_thin(*input.view, vertices, index, input.axes, threads, control, hull);
}

}  // namespace cullhull::internal
