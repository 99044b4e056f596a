// The range of coordinates, and which axes have whole numbers alone.
#pragma once

#include <cstdint>

#include "cullhull/point_view.hpp"

namespace cullhull::internal {

/// The ranges of the coordinates of points of up to three dimensions.
struct WholeRange {
  double low[3], high[3];
  bool whole[3];  ///< all values of the axis are whole and below 2^50 in magnitude
  bool finite;
};

/// Ranges of `count` > 0 packed rows of d = 2 or 3 numbers; unspecified unless all are finite.
WholeRange whole_range(const double* rows, std::uint32_t count, unsigned d);
/// Of the first `count` points of a view of two or three dimensions.
WholeRange whole_range(const PointView& points, std::uint64_t count);

}  // namespace cullhull::internal
