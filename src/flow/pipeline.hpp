// The two halves of the flow, shared by its drivers: filter_stage.hpp declares the first, this
// header the second.
#pragma once

#include "cullhull/hull.hpp"
#include "flow/filter_stage.hpp"
#include "hull/space/moved_surface.hpp"
#include "parallel/threads/clock.hpp"
#include "parallel/threads/run.hpp"

namespace cullhull::internal::inline flow {

/// Throws Error for null data, no dimension, a backend or an engine missing from this build.
void check_arguments(const PointView& points, const Options& options);

/// Runs the filter, and sets run.threads to the number that pays for the hull of the survivors.
Filtered filter_and_plan(const PointView& points, Run& run);

/// Whether few points are hulled directly or by frame and engine; both give the same bits.
enum class Few { at_once, by_engine };

/// A hull of the same points at other places, whose triangles are tried before an engine is.
struct KnownHull {
  const Hull* hull = nullptr;              ///< none
  const NearbyNumbers* numbers = nullptr;  ///< of it; or none
  bool tried = false, holds = false;
};

/// The hull of what a filter kept of `points`: thins lattices; frame, engine, result. Fills the
/// statistics except the times of the filter and of the whole. `known` is tried where it has the
/// survivors as vertices; the result is the same, bit for bit.
Hull hull_of_survivors(const PointView& points, Filtered&& filtered, const Run& run,
                       Few few = Few::at_once, KnownHull* known = nullptr);

}  // namespace cullhull::internal::inline flow
