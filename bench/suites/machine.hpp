// Suite `machine`: bandwidth of memory, of the link to the device and of the device, for the
// planner and to show a filter's speed as a share of the limit.
#pragma once

#include <cstdint>
#include <optional>
#include <stop_token>
#include <string>

#include "cullhull/options.hpp"

namespace cullhull::bench {

struct MachineSettings {
  /// Size in bytes of the array that is read or copied; 0: half a gigabyte, less on a small
  /// machine.
  std::uint64_t bytes = 0;
  /// Every rate is the best of this many passes, because disturbances can only slow a pass down.
  unsigned passes = 9;
};

/// Bytes per second; a copy counts both the bytes read and the bytes written.
struct HostRates {
  double read_one = 0, read_all = 0;  ///< with one core, with all cores
  double copy_one = 0, copy_all = 0;
};

struct DeviceRates {
  std::string name;
  double link_pinned = 0, link_pageable = 0;  ///< from host memory to device memory
  double copy = 0;                            ///< within the device
};

struct MachineRates {
  std::uint64_t bytes = 0;
  unsigned cores = 0;
  std::string date;  ///< 2026-01-31T12:00:00Z
  HostRates host;
  std::optional<DeviceRates> device;
  std::string no_device;  ///< the reason if there is none
};

/// Takes a few seconds. Throws Error{cancelled} between passes.
MachineRates measure_machine(const MachineSettings& settings, const Progress& progress,
                             const std::stop_token& stop);

/// Bytes per second that this many threads read from memory, the best of a few passes over half a
/// gigabyte (less on a small machine): the limit with which filters are compared.
double read_bandwidth(unsigned threads, const std::stop_token& stop);

std::string machine_table(const MachineRates& rates);
std::string machine_json(const MachineRates& rates);

/// The planner's constants as a flat JSON object: host_read_bytes_per_second,
/// host_copy_bytes_per_second (both on all cores), link_bytes_per_second (pinned),
/// device_copy_bytes_per_second, cores, date. Rates of a device only if there is one.
std::string planner_constants(const MachineRates& rates);

/// The rates of a device; empty if none can be used, with the reason in `reason`.
std::optional<DeviceRates> measure_device(std::uint64_t bytes, unsigned passes,
                                          const Progress& progress, const std::stop_token& stop,
                                          std::string& reason);

/// The current time, in the format of MachineRates.
std::string date_now();

}  // namespace cullhull::bench
