#include "tracker/frame_points.hpp"

#include <memory>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>

#include "cuda/device_rows.hpp"
#include "cuda/gauge.hpp"
#include "cuda/kernels/gauge_kernel.hpp"
#include "cuda/kernels/star_hull.hpp"
#include "cuda/runtime.hpp"
#include "cullhull/error.hpp"
#include "cullhull/hull.hpp"
#include "filter/planner.hpp"
#include "flow/pipeline.hpp"

namespace cullhull::internal {
namespace {

/// A frame of the tracker whose points are in a device's memory. Every operation runs on the device
/// until copy() has moved the points to the host, and on the host afterwards.
class DeviceFrame final : public FramePoints {
 public:
  DeviceFrame(const DevicePointView& points, const Run& run, std::shared_ptr<LastSurface>& last)
      : FramePoints(points.count, points.dimension),
        points_(points),
        run_(run),
        last_(last),
        reason_("CUDA device as asked") {
    check_arguments(points);
    if (count == 0) {
      (void)this_device();
      return;
    }
    scope_.emplace(device_of(points), run.options);
    if (run.options.cull == CullMethod::pseudo_hull) {
      copy("the pseudo-hull tracks on the CPU");
    } else if (run.options.backend == Backend::cpu) {
      copy("");
    } else if (run.options.backend == Backend::automatic) {
      const Placement place = place_of_device_points(points, run);
      reason_ = place.reason;
      if (!place.device) copy(place.reason);
    }
  }

  const PointView* on_host() const override { return here_ ? here_->on_host() : nullptr; }

  Array<double> gather(const std::vector<std::uint64_t>& ids) override {
    return there_or_here([&] { return gather_from_device(points_, ids, points_, run_); },
                         [&] { return here_->gather(ids); });
  }

  std::uint32_t most_nodes() override { return here_ ? here_->most_nodes() : most_map_nodes(); }

  bool keeps_surface() const override { return has_surface() && (!last_ || last_->kept); }
  bool has_surface() const {
    return !here_ && run_.options.cull == CullMethod::automatic &&
           surface_of_all_pays(dimension, count, run_);
  }

  void scan(const GaugeMap& map, Survivors& result) override {
    const std::string before = result.reason;
    there_or_here([&] { scan_there(map, result); },
                  [&] {
      result.reason = before;
      here_->scan(map, result);
      if (!why_here_.empty()) result.reason = before;  // hull() reports the reason
    });
  }

  void fetch(Filtered& result) override {
    there_or_here([&] { fetch_there(result); }, [&] { here_->fetch(result); });
  }

  Filtered filter_afresh() override {
    if (!here_) {
      Filtered filtered =
          run_device_filter(points_, run_, {.last = has_surface() ? &last_ : nullptr});
      if (!filtered.on_host) return filtered;
      keep(filtered.survivors.reason, std::move(filtered.rows));
    }
    return here_->filter_afresh();
  }

  Hull hull(Filtered&& filtered) override {
    if (!here_) return hull_of_rows(std::move(filtered), points_, run_.options);
    if (!why_here_.empty()) filtered.survivors.reason += "; " + why_here_;
    Hull hull = here_->hull(std::move(filtered));
    hull.scalar = points_.scalar;
    return hull;
  }

 private:
  /// Runs there() on the device. If the device's memory is exhausted and Backend::cuda was not
  /// required, copies the points to the host and runs here().
  template <class There, class Here>
  std::invoke_result_t<Here> there_or_here(const There& there, const Here& here) {
    if (here_) return here();
    try {
      return there();
    } catch (const OutOfMemory& e) {
      if (run_.options.backend == Backend::cuda) throw;
      copy(e.what());  // downloading packed points needs no device memory
    }
    return here();
  }

  /// Copies all points to the host. From then on the frame is processed on the host.
  void copy(const std::string& why) { keep(why, download_all(points_, run_)); }
  void keep(const std::string& why, Array<double>&& rows) {
    why_here_ = why;
    rows_ = std::move(rows);
    host_options_ = run_.options;
    host_options_.backend = Backend::cpu;
    host_run_.emplace(host_options_);
    here_.emplace(PointView::row_major(rows_.data(), count, dimension), *host_run_);
  }

  void scan_there(const GaugeMap& map, Survivors& result) const {
    result.all = false;
    result.backend = Backend::cuda;
    result.reason += "; " + reason_;
    const Array<std::uint64_t> ids = survivors_by_pieces(map.table(), points_, run_.control);
    require_room_for_survivors(ids.size(), dimension, run_);
    result.ids.assign(ids.begin(), ids.end());
  }

  void fetch_there(Filtered& result) const {
    const std::vector<std::uint64_t>& ids = result.survivors.ids;
    result.pass_survivors = ids.size();
    result.rows = download_finite(points_, ids.data(), ids.size(), ids.data(), run_);
    run_.control.report("cull", 0.8);
  }

  const DevicePointView points_;
  const Run& run_;
  std::shared_ptr<LastSurface>& last_;
  std::string reason_, why_here_;
  std::optional<DeviceScope> scope_;
  Array<double> rows_;  ///< rows of all points, after copy()
  Options host_options_;
  std::optional<Run> host_run_;
  std::optional<HostFrame> here_;
};

}  // namespace

std::unique_ptr<FramePoints> device_frame(const DevicePointView& points, const Run& run,
                                          std::shared_ptr<LastSurface>& last) {
  return std::make_unique<DeviceFrame>(points, run, last);
}

}  // namespace cullhull::internal
