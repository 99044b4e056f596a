// When the filter pays, and how large its samples should be. Pure functions of counts.
#pragma once

#include <cstdint>

namespace cullhull::internal {

/// Fewer points than this are hulled sooner than a map is built.
std::uint64_t smallest_worth_culling(unsigned d);
/// Fewer survivors than this are hulled sooner than a second map is built.
std::uint64_t smallest_worth_refining(unsigned d);

/// Points of the first, small sample, whose hull tells whether the filter pays.
std::uint64_t probe_sample_size(std::uint64_t count, unsigned d);

/// Whether culling `count` points saves time, where `extreme` of `sample` random ones were vertices
/// of the sample's hull.
bool cull_pays(std::uint64_t count, unsigned d, std::uint64_t sample, std::uint64_t extreme);

/// Points of the sample a map is laid on, from what the probe (as above) showed; at least `sample`
/// where the count allows it.
std::uint64_t map_sample_size(std::uint64_t count, unsigned d, std::uint64_t sample,
                              std::uint64_t extreme);

}  // namespace cullhull::internal
