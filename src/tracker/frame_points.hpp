// The points of a frame in host or device memory: the operations that the tracker needs.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "cullhull/device_points.hpp"
#include "cullhull/hull_fwd.hpp"
#include "filter/gauge/gauge_map.hpp"
#include "flow/pipeline.hpp"
#include "flow/sample_map.hpp"

namespace cullhull::internal {

/// gather_points() that names the first bad point of all points, if one of these is bad.
Array<double> gather_of_frame(const PointView& points, const std::vector<std::uint64_t>& ids,
                              const Run& run);

class FramePoints {
 public:
  FramePoints(std::uint64_t n, unsigned d) : count(n), dimension(d) {}
  virtual ~FramePoints() = default;
  FramePoints(const FramePoints&) = delete;
  FramePoints& operator=(const FramePoints&) = delete;

  const std::uint64_t count;
  const unsigned dimension;
  KnownHull known;  ///< for `hull`; not used for points in a device's memory

  /// The points, if they are in host memory; else null.
  virtual const PointView* on_host() const = 0;
  /// Packed rows of the points with these ids, which ascend; -0 becomes +0. If one of these points
  /// is bad, throws Error{not_finite} for the first bad point of the frame.
  virtual Array<double> gather(const std::vector<std::uint64_t>& ids) = 0;
  /// The largest number of a map's nodes that fit into the executor's cache; 0: the CPU's default.
  virtual std::uint32_t most_nodes() = 0;
  /// Whether filter_afresh() begins with the last frame's surface, where there is one.
  virtual bool keeps_surface() const { return false; }
  /// Scans all points: sets the survivors and the backend, and appends the choice's reason to
  /// `reason`.
  virtual void scan(const GaugeMap& map, Survivors& result) = 0;
  /// Gathers the rows of a scan's survivors. Throws Error{not_finite} for the first bad point of
  /// the frame.
  virtual void fetch(Filtered& result) = 0;
  /// Filters the points as convex_hull() does; without the last frame, but for its surface on a
  /// device.
  virtual Filtered filter_afresh() = 0;
  /// Computes the hull of a filter's survivors.
  virtual Hull hull(Filtered&& filtered) = 0;
};

/// Points in host memory. References points and run.
class HostFrame final : public FramePoints {
 public:
  HostFrame(const PointView& points, const Run& run);
  const PointView* on_host() const override { return &points_; }
  Array<double> gather(const std::vector<std::uint64_t>& ids) override;
  std::uint32_t most_nodes() override;
  void scan(const GaugeMap& map, Survivors& result) override;
  void fetch(Filtered& result) override;
  Filtered filter_afresh() override;
  Hull hull(Filtered&& filtered) override;

 private:
  CullPass& pass();

  const PointView points_;
  const Run& run_;
  std::optional<CullPass> pass_;  ///< created for the first scan
};

/// Points in a device's memory. Only leaders and survivors are copied to the host; all points are
/// copied if the CPU is requested or chosen, for the pseudo-hull, and if the device's memory is
/// full. Throws Error{backend_unavailable} if there is no device, Error{invalid_argument} for
/// memory that it cannot read.
/// `last` keeps the surface of the last frame there.
std::unique_ptr<FramePoints> device_frame(const DevicePointView& points, const Run& run,
                                          std::shared_ptr<LastSurface>& last);

}  // namespace cullhull::internal
