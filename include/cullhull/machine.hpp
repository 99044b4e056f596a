// What the planner knows about the machine.
#pragma once

#include <string>

#pragma GCC visibility push(default)
namespace cullhull::inline v1 {

/// Rates by which the planner chooses where points are culled. The defaults are guesses from below
/// for a desktop with a PCIe 3 device; `cullhull-bench machine` measures them (docs/gpu.md). Wrong
/// ones cost time, never correctness.
struct MachineConstants {
  double host_read_bytes_per_second = 20e9;     ///< all cores reading an array
  double host_copy_bytes_per_second = 10e9;     ///< all cores copying one, bytes copied
  double link_bytes_per_second = 12e9;          ///< pinned memory to the device
  double device_copy_bytes_per_second = 500e9;  ///< on the device, bytes read and written
  unsigned cores = 0;                           ///< 0: ask the system
  std::string date;                             ///< of the measurement; empty: none was made
};

}  // namespace cullhull::inline v1
#pragma GCC visibility pop
