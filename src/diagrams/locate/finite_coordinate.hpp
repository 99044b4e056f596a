// The check of a single query's coordinates.
#pragma once

#include <cmath>

#include "cullhull/error.hpp"

namespace cullhull::internal {

/// Throws Error{not_finite} for a NaN or an infinity.
inline void require_finite(double value, unsigned coordinate) {
  if (!std::isfinite(value))
    throw Error(ErrorCode::not_finite, "coordinate ", coordinate, " is ",
                (std::isnan(value) ? "NaN" : "infinite"));
}

}  // namespace cullhull::internal
