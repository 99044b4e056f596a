// When the filter pays, how large its samples should be, and where the points are culled. Pure
// functions of counts and rates.
#pragma once

#include <cstdint>
#include <string>

#include "cullhull/machine.hpp"

namespace cullhull::internal {

/// Fewer points than this are hulled sooner than a map is built.
std::uint64_t smallest_worth_culling(unsigned d);
/// Fewer survivors than this are hulled sooner than a second map is built.
std::uint64_t smallest_worth_refining(unsigned d);

/// Of `threads` those that pay: one, where all of it takes too little time to be shared. For the
/// filter of so many points, and for the hull of so many that it left.
unsigned useful_cull_threads(unsigned threads, std::uint64_t count, unsigned d);
unsigned useful_threads(unsigned threads, std::uint64_t count, unsigned d);

/// Points of the first, small sample, whose hull tells whether the filter pays.
std::uint64_t probe_sample_size(std::uint64_t count, unsigned d);

/// Whether culling `count` points saves time, where `extreme` of `sample` random ones were vertices
/// of the sample's hull.
bool cull_pays(std::uint64_t count, unsigned d, std::uint64_t sample, std::uint64_t extreme);

/// Points of the sample a map is laid on, from what the probe (as above) showed; at least `sample`
/// where the count allows it.
std::uint64_t map_sample_size(std::uint64_t count, unsigned d, std::uint64_t sample,
                              std::uint64_t extreme);

/// The same question once the sample of the map itself is hulled: its hull is paid for, so only
/// laying the map and the pass count. `extreme` of its `sample` points are vertices.
bool map_pays(std::uint64_t count, unsigned d, std::uint64_t sample, std::uint64_t extreme);

/// "132 of 1000 sampled points are extreme".
std::string sample_finding(std::uint64_t sample, std::uint64_t extreme);

/// Where a pass over points costs how much.
struct PlaceQuestion {
  std::uint64_t count = 0;
  unsigned dimension = 0;
  std::uint64_t point_bytes = 0;
  unsigned threads = 1;
  bool on_device = false;          ///< where the points are
  bool device_started = false;     ///< the driver has been used in this process
  std::uint64_t pinned_bytes = 0;  ///< of pinned memory that earlier calls left ready
};
struct Placement {
  bool device = false;
  std::string reason;       ///< with the estimates of both
  std::string host_reason;  ///< with that of the CPU alone, for where there is no device
};
/// Whether the device would have culled the points sooner; whether there is one is not asked.
Placement choose_place(const PlaceQuestion& question, const MachineConstants& machine);

}  // namespace cullhull::internal
