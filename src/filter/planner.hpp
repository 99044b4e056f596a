// When the filter pays, how large its samples should be, and where the points are culled. Pure
// functions of counts and rates.
#pragma once

#include <cstdint>
#include <string>

#include "cullhull/machine.hpp"

namespace cullhull::internal::inline filter {

/// Fewer points than this are hulled faster than a map is built.
std::uint64_t smallest_worth_culling(unsigned d);
/// Fewer survivors than this are hulled faster than a second map is built.
std::uint64_t smallest_worth_refining(unsigned d);

/// The number of `threads` that pays: one, where there is too little work to share. For the filter
/// of `count` points, and for the hull of `count` survivors.
unsigned useful_cull_threads(unsigned threads, std::uint64_t count, unsigned d);
unsigned useful_threads(unsigned threads, std::uint64_t count, unsigned d);

/// Points of the first, small sample, whose hull tells whether the filter pays.
std::uint64_t probe_sample_size(std::uint64_t count, unsigned d);

/// Whether culling `count` points saves time, where `extreme` of `sample` random ones were vertices
/// of the sample's hull.
bool cull_pays(std::uint64_t count, unsigned d, std::uint64_t sample, std::uint64_t extreme);

/// Size of the sample that a map is built from, given the probe's outcome (as above); at least
/// `sample` where the count allows it.
std::uint64_t map_sample_size(std::uint64_t count, unsigned d, std::uint64_t sample,
                              std::uint64_t extreme);

/// The same question once the sample of the map itself is hulled: its hull is paid for, so only
/// building the map and the pass count. `extreme` of its `sample` points are vertices.
bool map_pays(std::uint64_t count, unsigned d, std::uint64_t sample, std::uint64_t extreme);

/// "132 of 1000 sampled points are extreme".
std::string sample_finding(std::uint64_t sample, std::uint64_t extreme);

/// What decides where a pass over points is faster.
struct PlaceQuestion {
  std::uint64_t count = 0;
  unsigned dimension = 0;
  std::uint64_t point_bytes = 0;
  unsigned threads = 1;
  bool on_device = false;          ///< where the points are
  bool device_started = false;     ///< the driver was used in this process
  std::uint64_t pinned_bytes = 0;  ///< of pinned memory kept from earlier calls
};
struct Placement {
  bool device = false;
  std::string reason;       ///< with the estimates of both
  std::string host_reason;  ///< with that of the CPU alone, for where there is no device
};
/// Whether the device would cull the points faster; does not check that there is one.
Placement choose_place(const PlaceQuestion& question, const MachineConstants& machine);

}  // namespace cullhull::internal::inline filter
