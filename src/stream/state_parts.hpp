// Converts between a HullState and the points it holds, for HullStream and others.
#pragma once

#include <cstdint>
#include <utility>

#include "cullhull/stream.hpp"
#include "stream/numbered_points.hpp"

namespace cullhull::internal::inline stream {

struct StateParts {
  /// The state of `seen` points whose extreme points these are, ascending.
  static HullState state(const NumberedPoints& points, std::uint64_t seen) {
    HullState state;
    state.dimension_ = points.dimension;
    state.scalar_ = points.scalar;
    state.seen_ = seen;
    state.ids_.assign(points.ids.begin(), points.ids.end());
    state.rows_.assign(points.rows.begin(), points.rows.end());
    return state;
  }
  static NumberedPoints points(const HullState& state) {
    return {state.dimension_,
            state.scalar_,
            {state.ids_.begin(), state.ids_.end()},
            {state.rows_.begin(), state.rows_.end()}};
  }
};

}  // namespace cullhull::internal::inline stream
