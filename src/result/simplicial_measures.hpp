// What both ways to a simplicial result end with: area, volume and centroid.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "control.hpp"
#include "parallel/big_array.hpp"
#include "parallel/parallel.hpp"
#include "result/build_hull.hpp"
#include "result/facet_share.hpp"
#include "result/measure.hpp"
#include "result/measure_frame.hpp"
#include "result/surface.hpp"
#include "result/vertex_list.hpp"

namespace cullhull::internal {

/// From the sums over runs of facets, or afresh where those have lost too much: the hull is thin.
/// hull.simplices are in place.
template <unsigned K>
void finish_simplicial(const ResultInput& input, const VertexList& vertices, const Frame& frame,
                       const Share<K>* runs, unsigned threads, const Control& control, Hull& hull) {
  const std::uint64_t count = hull.simplices.size() / K;
  const Totals<DoubleDouble> all = total_of_runs(runs, chunk_count(count, measure_run), threads);
  if (settled(all, 0x1p-53)) return finish_measures(frame, all, hull);
  // Of a vertex among the vertices.
  const auto place_of = [&](std::uint64_t id) {
    if (input.ids == nullptr) return vertices.position(static_cast<std::uint32_t>(id));
    return static_cast<std::uint32_t>(
        std::lower_bound(vertices.ids.begin(), vertices.ids.end(), id) - vertices.ids.begin());
  };
  std::vector<std::uint32_t> index;
  resize_big(index, count * K);
  for_each_chunk(index.size(), simplex_chunk, threads,
                 [&](std::uint64_t, std::uint64_t begin, std::uint64_t end) {
                   control.check();
                   for (std::uint64_t i = begin; i < end; ++i)
                     index[i] = place_of(hull.simplices[i]);
                 });
  measure_thin(*input.view, vertices.ids, index, input.axes, threads, control, hull);
}

}  // namespace cullhull::internal
