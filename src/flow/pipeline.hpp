// The two halves of the flow, for the drivers above it: filter_stage.hpp is the first, this the
// second.
#pragma once

#include "cullhull/hull.hpp"
#include "flow/filter_stage.hpp"
#include "parallel/clock.hpp"
#include "parallel/run.hpp"

namespace cullhull::internal {

/// Throws Error for null data, no dimension, a backend or an engine this build has not.
void check_arguments(const PointView& points, const Options& options);

/// Whether few points are hulled without frame and engine, which gives the same bits.
enum class Few { at_once, by_engine };

/// From what a filter left of `points` to their hull: thin lattices, frame, engine, result. Fills
/// the statistics but for the times of the filter and of the whole.
Hull hull_of_survivors(const PointView& points, Filtered&& filtered, const Run& run,
                       Few few = Few::at_once);

}  // namespace cullhull::internal
