// Programs that time a triangulation: what they are asked, and what they answer.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "child.hpp"
#include "cullhull/point_view.hpp"

namespace cullhull::bench {

/// A Delaunay triangulation of somebody else's.
struct LiftedRun {
  double seconds = 0;       ///< for the triangulation alone
  bool finished = true;     ///< false: `seconds` is the limit it ran into, there are no cells
  std::uint64_t cells = 0;  ///< simplices, without unbounded ones
};

/// What a child said: the seconds and the number of simplices, as doubles in binary. Empty if it
/// said something else.
std::optional<LiftedRun> lifted_run(const std::optional<ChildRun>& child,
                                    const ChildLimits& limits);

/// Runs `program POINTS.npy WORD` on packed rows of doubles; empty where it failed.
std::optional<LiftedRun> run_lifting_program(const std::string& program, const char* word,
                                             const PointView& points, const ChildLimits& limits);

}  // namespace cullhull::bench
