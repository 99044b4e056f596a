// The rates of the machine that the planner uses.
#pragma once

#include <string>

#include "cullhull/version.hpp"

#pragma GCC visibility push(default)
namespace cullhull {

/// Rates from which the planner decides where points are filtered. The defaults are conservative
/// estimates for a desktop with a PCIe 3 device, not measured; `cullhull-bench machine` measures
/// them (docs/gpu.md). Wrong rates cost time, never correctness.
struct MachineConstants {
  double host_read_bytes_per_second = 20e9;     ///< all cores read an array
  double host_copy_bytes_per_second = 10e9;     ///< all cores copy an array, bytes copied
  double link_bytes_per_second = 12e9;          ///< from pinned memory to the device
  double device_copy_bytes_per_second = 500e9;  ///< copies on the device, bytes read and written
  unsigned cores = 0;                           ///< 0: number reported by the system
  std::string date;                             ///< date of the measurement; empty: not measured
};

}  // namespace cullhull
#pragma GCC visibility pop
