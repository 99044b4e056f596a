// The filter of a frame by the last frame's simplices: the paper's way for moving points.
#pragma once

#include <cstdint>
#include <vector>

#include "filter/pseudo_hull/pseudo_hull.hpp"
#include "flow/filter_stage.hpp"
#include "parallel/threads/run.hpp"

namespace cullhull::internal::inline tracker {

/// For every culled point the simplex of points that it was strictly inside of. In the next frame
/// the simplices' planes are recomputed at their corners' new positions, and each point is tested
/// against its own; only those no longer inside take part in growing a pseudo-hull again.
class SimplexMemory {
 public:
  /// Discards all simplices.
  void clear();

  /// The filter for a frame, in 2 to 8 dimensions, for more than d + 1 points. Every point it drops
  /// is strictly inside a simplex of points at their positions in this frame. `led` tells whether
  /// the last frame's simplices were used. Throws Error{not_finite} for the first bad point of all.
  Filtered filter(const PointView& points, const Run& run, bool& led, double& scan_seconds);

 private:
  std::vector<std::uint64_t> scan(const PointView& points, const Run& run);
  void grow(const PointView& points, Filtered& result, const Run& run);
  void remember(const SimplexRecord& found, const std::vector<std::uint64_t>* ids,
                std::uint64_t count);
  void compact();

  unsigned dimension_ = 0;
  std::vector<std::uint32_t> simplex_of_;  ///< by point; no_item: it survived
  std::vector<std::uint64_t> corners_;     ///< simplices x (dimension + 1) points
  std::uint64_t after_compaction_ = 0;     ///< number of simplices after the last compaction
};

}  // namespace cullhull::internal::inline tracker
