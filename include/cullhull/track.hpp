// Hulls of moving points, frame by frame: the last frame's vertices give the filter of the next.
#pragma once

#include <cstdint>
#include <memory>

#include "cullhull/device_points.hpp"
#include "cullhull/hull.hpp"
#include "cullhull/options.hpp"
#include "cullhull/point_view.hpp"

#pragma GCC visibility push(default)
namespace cullhull::inline v1 {

/// What one frame cost, and what it changed.
struct FrameReport {
  std::uint64_t index = 0;  ///< of the frame, from 0; frames that threw are counted
  /// "gauge" or "pseudo-hull": the filter was built from the last frame's hull. "static": computed
  /// as convex_hull does, for the first frame, for few points, and where the motion is not
  /// coherent.
  const char* method = "static";
  std::uint64_t scan_survivors = 0;  ///< points that the pass over all of them kept
  std::uint64_t survivors = 0;       ///< points left after growth, for the exact engine
  std::uint64_t vertices_came = 0, vertices_went = 0;  ///< against the frame before
  std::uint64_t facets_came = 0, facets_went = 0;      ///< facets as sets of vertices
  double scan_seconds = 0;                             ///< first map or simplices, and the pass
  double cull_seconds = 0;                             ///< the whole filter, the scan included
  double hull_seconds = 0;                             ///< engine and result
  double compute_seconds = 0;                          ///< points in memory to complete result
};

/// The exact convex hull of points that move.
///
/// Every hull is the one convex_hull gives for the same points, bit for bit (the statistics apart),
/// whatever the motion: the last frame only determines which points are looked at first. A point is
/// dropped only if it is proved to lie strictly inside a polytope of points at their new places
/// (docs/moving-points.md). Memory is kept from frame to frame, O(survivors + facets), and with
/// CullMethod::pseudo_hull also 4 bytes a point.
///
/// One tracker is for one thread at a time; trackers share nothing.
class HullTracker {
 public:
  /// `options` hold for every frame. `cull`: gauge and pseudo_hull are the two ways to use the last
  /// frame; automatic uses the gauge map where it helps; none computes every frame afresh.
  explicit HullTracker(Options options = {});
  HullTracker(HullTracker&&) noexcept;
  HullTracker& operator=(HullTracker&&) noexcept;
  ~HullTracker();

  /// The hull of the points at their new places: point i is the point i of the frame before, if
  /// count and dimension are the same; else tracking starts afresh. The hull stays valid until the
  /// next update. Throws what convex_hull throws, messages beginning with "frame N: "; the tracker
  /// then still knows the last hull that succeeded and takes the next frame from there.
  const Hull& update(const PointView& points);

  /// The same for points in a CUDA device's memory; host and device frames may alternate. Only the
  /// last hull's vertices and the survivors are transferred; all points are where Options::backend
  /// or the planner choose the CPU, with CullMethod::pseudo_hull, and where the device's memory is
  /// full. Throws what convex_hull(DevicePointView) throws; without a device or in a build without
  /// CUDA that is Error{backend_unavailable}.
  const Hull& update(const DevicePointView& points);

  const Hull& hull() const noexcept;  ///< the last one computed
  /// Of the last update that succeeded. The first call after an update compares its hull with that
  /// of the frame before, O(v log v + f) for v vertices and f facets; until then both are kept.
  const FrameReport& report() const;
  /// What the filter left of that frame's points.
  const Survivors& survivors() const noexcept;
  /// Forgets the last frame; frames are numbered from 0 again.
  void reset() noexcept;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace cullhull::inline v1
#pragma GCC visibility pop
