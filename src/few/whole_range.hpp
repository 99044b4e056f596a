// The range of coordinates in the plane, and which axes have whole numbers alone.
#pragma once

#include <cstdint>

namespace cullhull::internal::inline few {

struct WholeRange {
  double low[2], high[2];
  bool whole[2];  ///< all values of the axis are whole and below 2^50 in magnitude
  bool finite;
};

/// Of `count` > 0 packed pairs. Ranges are unspecified unless all values are finite.
WholeRange whole_range(const double* rows, std::uint32_t count);

}  // namespace cullhull::internal::inline few
