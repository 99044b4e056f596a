// Plane and share of the measures of a simplex facet in full dimension, from the normal that
// facet_block computed. The bits are part of the canonical result.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "parallel/threads/run.hpp"
#include "result/facets/facet_math.hpp"
#include "result/facets/facet_plane.hpp"
#include "result/measures/totals.hpp"

namespace cullhull::internal {

/// Returns the facet's share and writes its plane to out[0 .. K]. `vertex`: positions of its
/// vertices in stored order; `thin`: the normal is so short that it must be computed with more
/// bits; `sum`: the sum of the corners' differences from the hull's vertex 0.
template <unsigned K>
Share<K> facet_share(const Frame& frame, const FacetPlane<K>& plane, const std::uint32_t* vertex,
                     bool thin, const double* normal, const double* sum, double* out) {
  double n[K];
  std::copy_n(normal, K, n);
  const double largest = largest_of<K>(n);
  bool reliable = true;
  Share<K> share;
  share.area = share.area_error = root(square_of<K>(n));
  if (thin) {
    std::vector<double> scratch;
    share.area = plane.normal(vertex, n, scratch, &reliable, &share.area_error);
  }
  double corner[K], origin[K], sums[K];
  std::copy_n(frame.at(vertex[0]), K, corner);
  std::copy_n(frame.at(0), K, origin);
  std::copy_n(sum, K, sums);
  const FacetMoments<K, double> moments = moments_of<K>(n, corner, origin, sums);
  share.volume = moments.volume;
  share.error = share.area_error * moments.reach;
  std::copy_n(moments.moment, K, share.moment);
  if (thin || !(largest > 0x1p-400 && largest < 0x1p400)) {
    plane.write(vertex, n, reliable, out);
    return share;
  }
  double written[K + 1];
  plane_of<K>(n, share.area, corner, written);
  written[K] = scale_by(written[K], frame.exponent);
  std::copy_n(written, K + 1, out);
  return share;
}

/// Does the same for the facet in a lane of a block that facet_block and facet_shares have filled.
template <unsigned K>
[[gnu::always_inline]] inline Share<K> facet_share(const Frame& frame, const FacetPlane<K>& plane,
                                                   const std::uint32_t* vertex,
                                                   const FacetBlock<K>& block, unsigned lane,
                                                   double* out) {
  const bool thin = !(block.length[lane] > conditioned * block.edges[lane]);
  if (thin || !(block.largest[lane] > 0x1p-400 && block.largest[lane] < 0x1p400)) {
    double normal[K], sum[K];
    for (unsigned c = 0; c < K; ++c) {
      normal[c] = block.normal[c][lane];
      sum[c] = block.sum[c][lane];
    }
    return facet_share(frame, plane, vertex, thin, normal, sum, out);
  }
  Share<K> share;
  share.volume = block.volume[lane];
  share.area = share.area_error = block.length[lane];
  for (unsigned c = 0; c < K; ++c) {
    share.moment[c] = block.moment[c][lane];
    out[c] = block.plane[c][lane];
  }
  share.error = share.area_error * block.span[lane];
  out[K] = scale_by(block.plane[K][lane], frame.exponent);
  return share;
}

/// Sums the shares of all runs in canonical order.
template <unsigned K>
Totals<DoubleDouble> total_of_runs(const Share<K>* runs, std::uint64_t count, const Run& run) {
  constexpr std::uint64_t runs_a_chunk = measure_chunk / measure_run;
  std::vector<Share<K, DoubleDouble>> parts(chunk_count(count, runs_a_chunk));
  run.each_chunk(count, runs_a_chunk,
                 [&](std::uint64_t chunk, std::uint64_t begin, std::uint64_t end) {
    for (std::uint64_t i = begin; i < end; ++i) parts[chunk].add(runs[i]);
  });
  Share<K, DoubleDouble> all;
  for (const auto& p : parts) all.add(p);
  return Totals<DoubleDouble>(all);
}

}  // namespace cullhull::internal
