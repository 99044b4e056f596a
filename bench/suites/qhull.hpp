// Qhull on one core, the rival that every speed is shown beside.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "cullhull/point_view.hpp"

namespace cullhull::bench {

struct QhullRun {
  double seconds = 0;  ///< for its hull alone, with options Qt, as SciPy calls it; median
  double volume = 0;
  std::uint64_t vertices = 0;
};

/// `points` are packed rows of doubles. Nothing where this build has no Qhull, or where it failed.
std::optional<QhullRun> run_qhull(const PointView& points, unsigned repeat);

/// The middle one, the upper of two.
double median(std::vector<double> values);

}  // namespace cullhull::bench
