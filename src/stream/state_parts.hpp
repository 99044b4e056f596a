// Converts between a HullState and the points it holds, for HullStream and others.
#pragma once

#include <cstdint>
#include <utility>

#include "cullhull/stream.hpp"
#include "stream/numbered_points.hpp"

namespace cullhull::internal {

struct StateParts {
  /// The state of `seen` points whose extreme points these are, ascending.
  static HullState state(NumberedPoints&& points, std::uint64_t seen) {
    HullState state;
    state.dimension_ = points.dimension;
    state.scalar_ = points.scalar;
    state.seen_ = seen;
    state.ids_ = std::move(points.ids);
    state.rows_ = std::move(points.rows);
    return state;
  }
};

}  // namespace cullhull::internal
