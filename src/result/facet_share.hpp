// What a facet that is a simplex adds to the measures, and its plane: in full dimension, from the
// normal that facet_block gave. The bits are part of the canonical result.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "parallel/run.hpp"
#include "result/facet_plane.hpp"
#include "result/totals.hpp"

namespace cullhull::internal {

/// Sums over a run of at most `measure_run` facets, or one facet's share of them.
template <unsigned K>
struct Share {
  double volume = 0, area = 0;
  double moment[K] = {};
  double error = 0, area_error = 0;

  void add(const Share& o) {
    volume = volume + o.volume;
    area = area + o.area;
    for (unsigned c = 0; c < K; ++c) moment[c] = moment[c] + o.moment[c];
    error += o.error;
    area_error += o.area_error;
  }
};

/// `vertex`: positions in stored order; `thin`: the normal needs more bits than it got; `sum`: of
/// the corners' differences from vertex 0. Writes the plane to out[0 .. K].
template <unsigned K>
Share<K> facet_share(const Frame& frame, const FacetPlane<K>& plane, const std::uint32_t* vertex,
                     bool thin, const double* normal, const double* sum, double* out) {
  double n[K];
  double largest = 0;
  for (unsigned c = 0; c < K; ++c) {
    n[c] = normal[c];
    largest = std::max(largest, std::fabs(n[c]));
  }
  bool reliable = true;
  Share<K> share;
  share.area = length(n, K);
  share.error = share.area;
  if (thin) {
    std::vector<double> scratch;
    share.area = plane.normal(vertex, n, scratch, &reliable, &share.error);
  }
  share.area_error = share.error;
  const double* p = frame.at(vertex[0]);
  const double* o = frame.at(0);
  double reach = 0;
  for (unsigned c = 0; c < K; ++c) {
    const double step = p[c] - o[c];
    share.volume = share.volume + n[c] * step;
    reach = std::max(reach, std::fabs(step));
  }
  share.error *= reach;
  for (unsigned c = 0; c < K; ++c) share.moment[c] = share.volume * sum[c];
  if (thin || !(largest > 0x1p-400 && largest < 0x1p400)) {
    plane.write(vertex, n, reliable, out);
    return share;
  }
  double offset = 0;
  for (unsigned c = 0; c < K; ++c) {
    out[c] = n[c] / share.area;
    offset -= out[c] * p[c];
  }
  out[K] = scale_by(offset, frame.exponent);
  return share;
}

/// The shares of all runs, in canonical order.
template <unsigned K>
Totals<DoubleDouble> total_of_runs(const Share<K>* runs, std::uint64_t count, const Run& run) {
  constexpr std::uint64_t runs_a_chunk = measure_chunk / measure_run;
  std::vector<Totals<DoubleDouble>> parts(chunk_count(count, runs_a_chunk),
                                          Totals<DoubleDouble>(K));
  run.each_chunk(count, runs_a_chunk,
                 [&](std::uint64_t chunk, std::uint64_t begin, std::uint64_t end) {
                   Totals<DoubleDouble>& t = parts[chunk];
                   for (std::uint64_t i = begin; i < end; ++i) {
                     const Share<K>& share = runs[i];
                     t.volume = t.volume + DoubleDouble(share.volume);
                     t.area = t.area + DoubleDouble(share.area);
                     for (unsigned c = 0; c < K; ++c)
                       t.moment[c] = t.moment[c] + DoubleDouble(share.moment[c]);
                     t.error += share.error;
                     t.area_error += share.area_error;
                   }
                 });
  Totals<DoubleDouble> all(K);
  for (const auto& p : parts) all.add(p);
  return all;
}

}  // namespace cullhull::internal
