// Suite `machine`: bandwidth of memory, of the link and of the device, so that a cull's speed can
// be shown as a share of the limit, and for the planner.
#pragma once

#include <cstdint>
#include <optional>
#include <stop_token>
#include <string>

#include "cullhull/options.hpp"

namespace cullhull::bench {

struct MachineSettings {
  /// Size of the array that is read, or copied; 0: half a gigabyte, less on a small machine.
  std::uint64_t bytes = 0;
  /// Every rate is the best of so many passes, as disturbances can only slow a pass down.
  unsigned passes = 9;
};

/// Bytes per second; a copy counts the bytes read and the bytes written.
struct HostRates {
  double read_one = 0, read_all = 0;  ///< on one core, on all
  double copy_one = 0, copy_all = 0;
};

struct DeviceRates {
  std::string name;
  double link_pinned = 0, link_pageable = 0;  ///< from the host's memory to the device's
  double copy = 0;                            ///< within the device
};

struct MachineRates {
  std::uint64_t bytes = 0;
  unsigned cores = 0;
  std::string date;  ///< 2026-01-31T12:00:00Z
  HostRates host;
  std::optional<DeviceRates> device;
  std::string no_device;  ///< why there is none
};

/// Measures for a few seconds. Throws Error{cancelled} between passes.
MachineRates measure_machine(const MachineSettings& settings, const Progress& progress,
                             const std::stop_token& stop);

/// Bytes per second that so many threads read from memory, the best of a few passes over half a
/// gigabyte (less on a small machine): the limit that filters are compared with.
double read_bandwidth(unsigned threads, const std::stop_token& stop);

std::string machine_table(const MachineRates& rates);
std::string machine_json(const MachineRates& rates);

/// The planner's constants, a flat JSON object: host_read_bytes_per_second,
/// host_copy_bytes_per_second (both on all cores), link_bytes_per_second (pinned),
/// device_copy_bytes_per_second, cores, date. Those of a device only where there is one.
std::string planner_constants(const MachineRates& rates);

/// The part about a device; empty, with the reason in `reason`, where none can be used.
std::optional<DeviceRates> measure_device(std::uint64_t bytes, unsigned passes,
                                          const Progress& progress, const std::stop_token& stop,
                                          std::string& reason);

/// The present time, as in MachineRates.
std::string date_now();

}  // namespace cullhull::bench
