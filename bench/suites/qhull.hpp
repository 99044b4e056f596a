// Qhull on one core, the rival that every speed is shown beside.
#pragma once

#include <cstdint>
#include <optional>

#include "child.hpp"
#include "cullhull/point_view.hpp"
#include "lifting_rivals.hpp"

namespace cullhull::bench {

struct QhullRun {
  double seconds = 0;  ///< for its hull alone, with options Qt, as SciPy calls it
  double volume = 0;
  std::uint64_t vertices = 0;
  bool finished = true;  ///< false: `seconds` is the limit it ran into, the rest is nothing
};

/// `points` are packed rows of doubles. Nothing where this build has no Qhull, or where it failed.
/// Runs in a process of its own; throws Error{cancelled}.
std::optional<QhullRun> run_qhull(const PointView& points, const ChildLimits& limits);

/// The Delaunay triangulation with the options that SciPy calls Qhull with. As run_qhull().
std::optional<LiftedRun> run_qhull_delaunay(const PointView& points, const ChildLimits& limits);

/// Whether this build has Qhull.
bool has_qhull();

/// Seconds of Qhull's hull of packed rows of doubles in this process, its memory given back: for
/// small sets, of which a process of their own would be most. 0 without Qhull.
double qhull_seconds(const PointView& points);

}  // namespace cullhull::bench
