// Explains why CUDA cannot be used, from the answers of CUDA's run-time library. It is a pure
// function, so that every outcome can be tested on machines without a device.
#pragma once

#include <driver_types.h>

#include <string>

namespace cullhull::internal {

/// The oldest architecture for which kernels are compiled; 75 is compute capability 7.5.
inline constexpr int oldest_capability = 75;

/// Answers of the run-time library.
struct Probe {
  cudaError_t error = cudaSuccess;  ///< status of counting the devices
  int driver_version = 0;           ///< newest CUDA that the driver supports; 0: no driver
  int runtime_version = 0;
  int devices = 0;
  std::string name;
  int capability = 0;                    ///< compute capability; 90 for 9.0
  cudaError_t code_error = cudaSuccess;  ///< status of looking for kernels for the device
};

/// One line that names the problem and the remedy; empty if CUDA can be used.
std::string unavailable_reason(const Probe& probe);

}  // namespace cullhull::internal
