// Volume, area, centroid and facet planes of a hull whose combinatorics are final.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "cullhull/hull.hpp"
#include "parallel/memory/raw_array.hpp"
#include "parallel/threads/run.hpp"
#include "result/boundary.hpp"
#include "result/build_hull.hpp"
#include "result/facets/facet_share.hpp"
#include "result/measures/measure_frame.hpp"

namespace cullhull::internal {

/// Computes volume, area, centroid and facet_planes from the other fields. `vertices`: the
/// vertices' ids, ascending. `vertex_index[i * k + j]`: the position in `vertices` of vertex j of
/// simplex i. `axes`: k coordinate axes onto which the points' flat projects one to one. The sums
/// run in canonical order over chunks of fixed size, so their bits do not depend on the number of
/// threads.
void measure(const PointView& points, const std::vector<std::uint64_t>& vertices,
             const std::vector<std::uint32_t>& vertex_index, const unsigned* axes, const Run& run,
             Hull& hull);

/// Computes only volume, area and centroid, in double-doubles or exactly, for a simplicial hull
/// whose planes exist and which is so thin that sums in doubles are not accurate enough.
void measure_thin(const PointView& points, const std::vector<std::uint64_t>& vertices,
                  const std::vector<std::uint32_t>& vertex_index, const unsigned* axes,
                  const Run& run, Hull& hull);

/// The measures of a hull in the plane or in space, before they are written.
struct Measures {
  double volume = 0, area = 0, centroid[3] = {};
};

/// Computes them from the sums, in units of 2^exponent, where doubles leave a rounding uncertain.
/// `first`: the lowest id of a vertex.
template <unsigned K>
void finish_with_care(const PointView& points, std::uint64_t first, int exponent,
                      const double (&origin)[K], const Share<K, DoubleDouble>& sums, Measures& out);
extern template void finish_with_care(const PointView&, std::uint64_t, int, const double (&)[2],
                                      const Share<2, DoubleDouble>&, Measures&);
extern template void finish_with_care(const PointView&, std::uint64_t, int, const double (&)[3],
                                      const Share<3, DoubleDouble>&, Measures&);

/// Computes the measures in dimension K = 2 or 3. Returns false if rounding could show in them (a
/// thin hull): the general code is then needed.
template <unsigned K>
[[gnu::flatten]] bool finish_plain(const PointView& points, std::uint64_t first, int exponent,
                                   const Share<K, DoubleDouble>& sums, Measures& out) {
  if (!settled(sums, 0x1p-53)) return false;
  double origin[K];
  for (unsigned c = 0; c < K; ++c) origin[c] = scale_by(points.at(first, c), -exponent);
  if (!finish_quickly(K, exponent, origin, sums.volume, sums.area, sums.moment, &out.volume,
                      &out.area, out.centroid))
    finish_with_care(points, first, exponent, origin, sums, out);
  return true;
}

/// The last step of write_triangles and write_simplices: computes area, volume and centroid from
/// the sums over runs of facets, or again with more bits if those are not accurate enough (thin
/// hulls). `vertices`: the vertices' ids, ascending. hull.simplices must be complete.
template <unsigned K>
void finish_simplicial(const ResultInput& input, const std::vector<std::uint64_t>& vertices,
                       const Frame& frame, const Share<K>* runs, const Run& run, Hull& hull) {
  const std::uint64_t count = hull.simplices.size() / K;
  const Totals<DoubleDouble> all = total_of_runs(runs, chunk_count(count, measure_run), run);
  if (settled(all, 0x1p-53)) return finish_measures(frame, all, hull);
  std::vector<std::uint32_t> index;
  resize_big(index, count * K);
  run.each(index.size(), simplex_chunk, [&](std::uint64_t begin, std::uint64_t end) {
    for (std::uint64_t i = begin; i < end; ++i)
      index[i] = static_cast<std::uint32_t>(
          std::lower_bound(vertices.begin(), vertices.end(), hull.simplices[i]) - vertices.begin());
  });
  measure_thin(*input.view, vertices, index, input.axes, run, hull);
}

}  // namespace cullhull::internal
