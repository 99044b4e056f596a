// What a run cost.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <vector>

#include "cullhull/point_view.hpp"
#include "timing.hpp"

namespace app {

class Stopwatch {
 public:
  double seconds() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

/// Brings every page of a mapped input into memory; returns the seconds that took, which are
/// reading, not computing. Leaves alone what would fill more than half of the memory.
double warm_pages(const cullhull::PointView& points);

/// Largest resident set of this process so far, mapped input included.
std::uint64_t peak_bytes();

using cullhull::bench::median;

/// Index of the run whose time is the median (the lower one of an even number).
std::size_t median_run(const std::vector<double>& seconds);

}  // namespace app
