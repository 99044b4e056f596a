// The points of a frame, wherever they lie: what the tracker asks of them.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "cull/gauge_map.hpp"
#include "cullhull/device_points.hpp"
#include "cullhull/hull.hpp"
#include "flow/cull_pass.hpp"
#include "flow/filter_stage.hpp"
#include "parallel/run.hpp"

namespace cullhull::internal {

class FramePoints {
 public:
  FramePoints(std::uint64_t n, unsigned d) : count(n), dimension(d) {}
  virtual ~FramePoints() = default;
  FramePoints(const FramePoints&) = delete;
  FramePoints& operator=(const FramePoints&) = delete;

  const std::uint64_t count;
  const unsigned dimension;

  /// The points as the host can read them; null: it cannot.
  virtual const PointView* on_host() const = 0;
  /// Packed rows of the points with these ids, which ascend; -0 becomes +0. Throws
  /// Error{not_finite} for the first bad point of all if one of these is bad.
  virtual Array<double> gather(const std::vector<std::uint64_t>& ids) = 0;
  /// Nodes of a map the scan can hold close by; 0: the CPU's choice.
  virtual std::uint32_t most_nodes() = 0;
  /// Sets what the map keeps, where that was found, and adds why there to the reason.
  virtual void scan(const GaugeMap& map, Survivors& result) = 0;
  /// The rows of what a scan kept. Throws Error{not_finite} for the first bad point of all.
  virtual void fetch(Filtered& result) = 0;
  /// The filter of a single set of points.
  virtual Filtered filter_afresh() = 0;
  /// The hull of what a filter left.
  virtual Hull hull(Filtered&& filtered) = 0;
};

/// Points in the host's memory. Views points and run.
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
  FirstPass& pass();

  const PointView points_;
  const Run& run_;
  std::optional<FirstPass> pass_;  ///< where it runs is decided when a scan is wanted
};

/// Points in a device's memory, which only leaders and survivors leave; all of them do where the
/// CPU is asked for or chosen, for the pseudo-hull, and where the device's memory is full. Throws
/// Error{backend_unavailable} where there is no device, Error{invalid_argument} for memory it does
/// not read.
std::unique_ptr<FramePoints> device_frame(const DevicePointView& points, const Run& run);

}  // namespace cullhull::internal
