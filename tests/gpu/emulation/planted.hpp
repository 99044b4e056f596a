// Errors behind switches, which planted_errors.py writes into the texts.
#pragma once

#include <cstdint>

namespace emulation {

/// The number of the error to make, which the environment variable CULLHULL_PLANTED names; that of
/// an empty name if none is to be made.
extern const std::uint32_t planted_error;

}  // namespace emulation
