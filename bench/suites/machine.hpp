// What reports say of the machine and the moment.
#pragma once

#include <stop_token>
#include <string>

namespace cullhull::bench {

/// Bytes per second that this many threads read from memory, the best of a few passes over half a
/// gigabyte (less on a small machine): the limit with which filters are compared. Throws
/// Error{cancelled} between passes.
double read_bandwidth(unsigned threads, const std::stop_token& stop);

/// The current time: 2026-01-31T12:00:00Z.
std::string date_now();

}  // namespace cullhull::bench
