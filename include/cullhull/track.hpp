// Hulls of moving points, frame by frame: the last frame's vertices give the next frame's filter.
#pragma once

#include <cstdint>
#include <memory>

#include "cullhull/device_points.hpp"
#include "cullhull/hull_fwd.hpp"
#include "cullhull/options.hpp"
#include "cullhull/point_view.hpp"

#pragma GCC visibility push(default)
namespace cullhull {

/// Cost of a frame, and how its hull differs from that of the frame before.
struct FrameReport {
  std::uint64_t index = 0;  ///< of the frame, from 0; frames that threw count, too
  /// The filter. "gauge" or "pseudo-hull": built from the last frame's hull (on a device, in
  /// space, "pseudo-hull" from its surface). "static": computed as by convex_hull, for the first
  /// frame, for few points, and if the motion is not coherent.
  const char* method = "static";
  std::uint64_t scan_survivors = 0;  ///< points kept by the scan of all points
  std::uint64_t survivors = 0;       ///< points that the whole filter left for the engine
  std::uint64_t vertices_came = 0, vertices_went = 0;  ///< new and lost since the frame before
  std::uint64_t facets_came = 0, facets_went = 0;      ///< facets, compared as sets of vertices
  double scan_seconds = 0;                             ///< first map or simplices, and the scan
  double cull_seconds = 0;                             ///< the whole filter, including the scan
  double hull_seconds = 0;                             ///< engine and result
  double compute_seconds = 0;                          ///< points in memory to complete result
};

/// The exact convex hull of points that move.
///
/// Every hull equals convex_hull of the same points, bit for bit (except for statistics), for any
/// motion: the last frame only determines which points are tested first. A point is discarded only
/// if it is proved to be strictly inside a polytope of points at their new positions
/// (docs/moving-points.md). Memory is reused from frame to frame: O(survivors + facets), and with
/// CullMethod::pseudo_hull 4 bytes per point more.
///
/// Not thread safe: use a tracker from one thread at a time. Trackers share nothing.
class HullTracker {
 public:
  /// `options` apply to every frame. `cull`: gauge and pseudo_hull are two filters built from the
  /// last frame; automatic uses the gauge map where it is worthwhile; none computes every frame
  /// afresh.
  explicit HullTracker(Options options = {});
  HullTracker(HullTracker&&) noexcept;
  HullTracker& operator=(HullTracker&&) noexcept;
  ~HullTracker();

  /// The hull of the points at their new positions. Point i is point i of the frame before, if
  /// count and dimension are the same; else tracking starts afresh. The hull is valid until the
  /// next update. Throws what convex_hull throws, with messages beginning "frame N: "; the tracker
  /// then keeps the last hull that succeeded and uses it for the next frame.
  const Hull& update(const PointView& points);

  /// The same for points in a CUDA device's memory; host and device frames may alternate. Only the
  /// last hull's vertices and the survivors are transferred. All points are transferred if
  /// Options::backend or the planner choose the CPU, with CullMethod::pseudo_hull, and if the
  /// device's memory is full. Throws what convex_hull(DevicePointView) throws; without a device or
  /// CUDA backend Error{backend_unavailable}.
  const Hull& update(const DevicePointView& points);

  const Hull& hull() const noexcept;  ///< the last hull computed
  /// The same without a copy, for longer than until the next update.
  std::shared_ptr<const Hull> shared_hull() const noexcept;
  /// Report of the last update that succeeded. The first call after an update compares its hull
  /// with that of the frame before, in O(v log v + f) for v vertices and f facets; both hulls are
  /// kept until then or until the next update has filtered its points: if that one is stopped or
  /// fails later, changes that nobody had asked for count as 0.
  const FrameReport& report() const;
  /// Points of that frame that the filter kept.
  const Survivors& survivors() const noexcept;
  /// Forgets the last frame; the next one has index 0.
  void reset() noexcept;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace cullhull
#pragma GCC visibility pop
