// Moving points.
#include <nanobind/nanobind.h>
#include <nanobind/stl/unique_ptr.h>

#include <atomic>
#include <memory>
#include <stop_token>
#include <utility>
#include <vector>

#include "arrays.hpp"
#include "cullhull/track.hpp"
#include "device_points.hpp"
#include "points.hpp"
#include "solid.hpp"

namespace binding {

using cullhull::FrameReport;
using cullhull::HullTracker;
using cullhull::Options;

namespace {

/// A tracker keeps the options of its construction; here each update can be stopped and observed
/// separately. A requested stop cannot be withdrawn, so an interrupted tracker starts afresh.
class Tracker {
 public:
  /// `frames`: the number of frames before, for a tracker that continues another one.
  Tracker(const Settings* settings, std::uint64_t frames)
      : options_(settings_or_default(settings).options), frames_(frames) {
    start();
  }
  ~Tracker() {
    const nb::gil_scoped_release release;  // freeing a device's memory may wait
    tracker_.reset();
  }
  Tracker(const Tracker&) = delete;
  Tracker& operator=(const Tracker&) = delete;

  std::unique_ptr<Solid> update(nb::handle array, const Settings* settings) {
    const Points points(array);
    return next(settings, length_of_hull(points.view()), [&] {
      tracker_->update(points.view());
      return std::make_unique<Solid>(tracker_->shared_hull(), points.view());
    });
  }
  std::unique_ptr<Solid> update_on_device(const DevicePoints& points, const Settings* settings) {
    return next(settings, Length::long_, [&] {
      const auto rows = cullhull::fetch_points(points.view, tracker_->update(points.view).vertices);
      return std::make_unique<Solid>(tracker_->shared_hull(),
                                     std::vector<double>(rows.begin(), rows.end()));
    });
  }
  void reset() {
    const Busy busy(busy_, updating);
    start();
    frames_ = frame_ = 0;
  }
  std::uint64_t frames() const { return frames_; }
  /// The report of the last update that succeeded.
  nb::typed<nb::dict, nb::str, nb::any> report() {
    const Busy busy(busy_, updating);
    const FrameReport& r = tracker_->report();
    nb::typed<nb::dict, nb::str, nb::any> all;
    all["index"] = frame_;
    all["method"] = r.method;
    all["scan_survivors"] = r.scan_survivors;
    all["survivors"] = r.survivors;
    all["vertices_came"] = r.vertices_came;
    all["vertices_went"] = r.vertices_went;
    all["facets_came"] = r.facets_came;
    all["facets_went"] = r.facets_went;
    all["scan_seconds"] = r.scan_seconds;
    all["cull_seconds"] = r.cull_seconds;
    all["hull_seconds"] = r.hull_seconds;
    all["compute_seconds"] = r.compute_seconds;
    return all;
  }

 private:
  static constexpr const char* updating = "updating this tracker";

  /// compute(): the hull of the next frame.
  template <class Compute>
  std::unique_ptr<Solid> next(const Settings* settings, Length length, const Compute& compute) {
    const Busy busy(busy_, updating);
    std::unique_ptr<Solid> solid;
    try {
      run(settings, length, [&](const Options& call) {
        const std::stop_callback pass_on(call.stop, [this] { stop_.request_stop(); });
        call_ = &call;
        solid = compute();
      });
    } catch (...) {
      ++frames_;
      if (stop_.stop_requested()) start();
      throw;
    }
    frame_ = frames_++;
    return solid;
  }

  void start() {
    stop_ = std::stop_source();
    Options options = options_;
    options.stop = stop_.get_token();
    options.progress = [this](const char* phase, double share) {
      if (call_->progress) call_->progress(phase, share);
    };
    options.poll = [this] {
      if (call_->poll) call_->poll();
    };
    tracker_ = std::make_unique<HullTracker>(std::move(options));
  }

  Options options_;
  std::stop_source stop_;
  const Options* call_ = nullptr;  // of the present update
  std::unique_ptr<HullTracker> tracker_;
  std::uint64_t frames_ = 0, frame_ = 0;
  std::atomic<bool> busy_{false};
};

}  // namespace

void bind_tracker(nb::module_& m) {
  nb::class_<Tracker>(m, "Tracker", "Hulls of moving points: cullhull.HullTracker wraps it.")
      .def(nb::init<const Settings*, std::uint64_t>(), nb::arg("settings").none(),
           nb::arg("frames") = 0)
      .def_prop_ro("frames", &Tracker::frames)
      .def("update", &Tracker::update, nb::arg("points"), nb::arg("settings").none())
      .def("update_on_device", &Tracker::update_on_device, nb::arg("points"),
           nb::arg("settings").none())
      .def("reset", &Tracker::reset)
      .def_prop_ro("report", &Tracker::report);
}

}  // namespace binding
