// The two filters of a frame, by the last frame's simplices (the paper's method for moving points)
// and by a gauge map on the last frame's vertices; and the changes between two hulls.
#pragma once

#include <cstdint>
#include <vector>

#include "cullhull/hull_fwd.hpp"
#include "cullhull/track.hpp"
#include "filter/pseudo_hull/pseudo_hull.hpp"
#include "flow/pipeline.hpp"
#include "tracker/frame_points.hpp"

namespace cullhull::internal {

/// For each discarded point, a simplex of points that contained it strictly. In the next frame the
/// simplices' planes are recomputed at their corners' new positions, and each point is tested
/// against its own simplex; a pseudo-hull is grown again only for points no longer inside.
class SimplexMemory {
 public:
  /// Discards all simplices.
  void clear();

  /// Filters a frame, in 2 to 8 dimensions, for more than d + 1 points. Every discarded point is
  /// strictly inside a simplex of points at their positions in this frame. `led` becomes true if
  /// the last frame's simplices were used. Throws Error{not_finite} for the first bad point of the
  /// frame.
  Filtered filter(const PointView& points, const Run& run, bool& led, double& scan_seconds);

 private:
  std::vector<std::uint64_t> scan(const PointView& points, const Run& run);
  void grow(const PointView& points, Filtered& result, const Run& run);
  void remember(const SimplexRecord& found, const std::vector<std::uint64_t>* ids,
                std::uint64_t count);
  void compact();

  unsigned dimension_ = 0;
  std::vector<std::uint32_t> simplex_of_;  ///< for each point; no_item: it survived
  std::vector<std::uint64_t> corners_;     ///< simplices x (dimension + 1) point ids
  std::uint64_t after_compaction_ = 0;     ///< number of simplices after the last compaction
};

// The filter by a gauge map on the last frame's vertices (the leaders).

/// Discards points that are strictly inside the hull of the points `leaders` (ids, ascending) at
/// their new positions. Returns false and does nothing if these give no map: too few, in a flat, or
/// a hull beyond the budget. Throws Error{not_finite} for the first bad point of the frame.
bool filter_by_leaders(FramePoints& points, const Hull& last,
                       const std::vector<std::uint64_t>& leaders, const Run& run, Filtered& result,
                       double& scan_seconds);

// The changes from one hull to the next.

/// Counts new and lost vertices and facets. Linear in the sizes of the hulls.
void count_changes(const Hull& before, const Hull& after, FrameReport& report);

}  // namespace cullhull::internal
