// Programs that time a triangulation: their arguments and their output.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "child.hpp"
#include "cullhull/point_view.hpp"

namespace cullhull::bench {

/// A Delaunay triangulation by a rival.
struct LiftedRun {
  double seconds = 0;       ///< of the triangulation alone
  bool finished = true;     ///< false: `seconds` is the limit that was exceeded, and `cells` is 0
  std::uint64_t cells = 0;  ///< simplices, without unbounded ones
};

/// Reads a child's output: the seconds and the number of simplices, as doubles in binary. Empty for
/// any other output.
std::optional<LiftedRun> lifted_run(const std::optional<ChildRun>& child,
                                    const ChildLimits& limits);

/// Runs `program POINTS.npy WORD` on packed rows of doubles; empty on failure.
std::optional<LiftedRun> run_lifting_program(const std::string& program, const char* word,
                                             const PointView& points, const ChildLimits& limits);

}  // namespace cullhull::bench
