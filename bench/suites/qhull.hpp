// Qhull on one core, the rival that is always measured.
#pragma once

#include <cstdint>
#include <optional>

#include "child.hpp"
#include "cullhull/point_view.hpp"
#include "lifting_rivals.hpp"

namespace cullhull::bench {

struct QhullRun {
  double seconds = 0;  ///< for its hull alone, with option Qt, as SciPy calls it
  double volume = 0;
  std::uint64_t vertices = 0;
  bool finished = true;  ///< false: `seconds` is the limit that was exceeded, all else is unset
};

/// `points` are packed rows of doubles. Empty if this build has no Qhull, and on failure. Runs in a
/// separate process; throws Error{cancelled}.
std::optional<QhullRun> run_qhull(const PointView& points, const ChildLimits& limits);

/// The Delaunay triangulation with the options that SciPy uses for Qhull. As run_qhull().
std::optional<LiftedRun> run_qhull_delaunay(const PointView& points, const ChildLimits& limits);

/// Whether this build has Qhull.
bool has_qhull();

/// Seconds of Qhull's hull of packed rows of doubles in this process, including freeing its memory:
/// for small sets, for which starting a process would take most of the time. 0 without Qhull.
double qhull_seconds(const PointView& points);

}  // namespace cullhull::bench
