// Why CUDA cannot be used, from the run-time library's answers: a pure function, so that every
// outcome is tested on machines without a device.
#pragma once

#include <driver_types.h>

#include <string>

namespace cullhull::internal::inline cuda {

/// Oldest architecture there is code for.
inline constexpr int oldest_capability = 75;

struct Probe {
  cudaError_t error = cudaSuccess;  ///< of counting the devices
  int driver_version = 0;           ///< newest CUDA the driver supports; 0: there is no driver
  int runtime_version = 0;
  int devices = 0;
  std::string name;
  int capability = 0;                    ///< of the device; 90 for 9.0
  cudaError_t code_error = cudaSuccess;  ///< of looking for our code for it
};

/// One line that says what to do; empty where CUDA can be used.
std::string unavailable_reason(const Probe& probe);

}  // namespace cullhull::internal::inline cuda
