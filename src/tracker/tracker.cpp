// HullTracker: chooses the filter of each frame, and keeps state for the next frame.
#include <algorithm>
#include <optional>
#include <utility>

#include "cullhull/error.hpp"
#include "cullhull/track.hpp"
#include "few/few_points.hpp"
#include "filter/ways.hpp"
#include "flow/pipeline.hpp"
#include "parallel/memory/pages.hpp"
#include "parallel/sort_few.hpp"
#include "parallel/threads/helpers.hpp"
#include "parallel/threads/run.hpp"
#include "tracker/frame_points.hpp"
#include "tracker/simplex_memory.hpp"

namespace cullhull {

using namespace internal;

namespace {

/// Number of frames to wait after the last hull's triangles did not hold. A failed attempt costs up
/// to an eighth of a frame; the wait doubles each time, up to 32 frames.
constexpr std::uint64_t least_surface_penalty = 4;

/// Points are filtered by leaders from `least_led` points on; in 3D those that a map of the
/// outermost ones filters are, if the filter without them leaves `least_left` times as many points
/// as there are vertices. Frames of a twisted surface with relief take 0.72 of the time with 50,000
/// points, 0.8 to 0.9 with 20,000; if each point moves by itself, 1.2 with 10,000 and 20,000.
constexpr std::uint64_t least_led = 32768, least_left = 3;

}  // namespace

struct HullTracker::Impl {
  Options options;
  std::uint64_t frame = 0;
  bool known = false;  ///< `hull` is the hull of an earlier frame
  /// `before` is the hull of the frame before, until `report` includes the changes or the next hull
  /// is begun. They are counted only on request, because that takes up to a tenth of a frame.
  std::shared_ptr<Hull> hull = std::make_shared<Hull>(), before;
  bool compared = true;
  FrameReport report;
  Survivors survivors;
  /// Frames left before leaders are tried again, and the length of the next such pause.
  std::uint64_t pause = 0, penalty = 1;
  /// What the filter without leaders left of the last frame that it filtered.
  std::uint64_t left_afresh = 0;
  /// The same for trying the last hull's triangles.
  std::uint64_t surface_pause = 0, surface_penalty = least_surface_penalty;
  std::optional<NearbyNumbers> numbers;  ///< of `hull`, while its triangles hold
  SimplexMemory simplices;
  std::shared_ptr<LastSurface> surface;  ///< on a device

  /// Whether the last frame has the same count and dimension.
  bool follows(const FramePoints& points) const {
    return known && hull->point_count == points.count && hull->dimension == points.dimension;
  }

  /// Whether a map of the outermost points filters these points without leaders.
  static bool is_small(const FramePoints& points) {
    return points.dimension == 3 && points.on_host() != nullptr &&
           points.count <= row_of(Way::outermost).most;
  }

  bool wants_gauge(const FramePoints& points) const {
    const unsigned d = points.dimension;
    if (!takes(Way::gauge, way_question(points, options)) || hull->vertices.size() <= d ||
        points.keeps_surface())
      return false;
    if (options.cull == CullMethod::gauge) return true;
    // A filter that takes little longer than one pass gains from leaders only where it leaves much
    // more than they do: points near a surface with relief, not a ball or a normal distribution.
    if (is_small(points))
      return pause == 0 && points.count >= least_led && hull->vertices.size() <= points.count / 8 &&
             left_afresh >= least_left * hull->vertices.size();
    const bool on_host = points.on_host() != nullptr;
    // From 4D on a leader costs 3 us in 4D, 12 to 30 in 5D, 190 in 6D, and each point that the
    // filter without leaders leaves to the engine 0.1 to 0.3 us.
    if (on_host && d > 3)
      return pause == 0 && points.count >= least_led &&
             left_afresh >> (2 * (d - 3)) >= 5 * hull->vertices.size();
    // The leaders' hull costs about their share of the points times the hull of all points without
    // a filter: at most an eighth is accepted. In 3D a filter without leaders is built faster than
    // many leaders are processed (measured in docs/moving-points.md), hence the lower limit.
    const std::uint64_t least_per_leader = d == 3 && on_host ? 192 : 8;
    return pause == 0 && hull->vertices.size() <= points.count / least_per_leader;
  }

  Filtered filter(FramePoints& points, const Run& run, FrameReport& now) {
    if (points.on_host() != nullptr && takes(Way::pseudo_hull, way_question(points, options))) {
      bool led = false;
      if (!follows(points)) simplices.clear();
      Filtered filtered = simplices.filter(*points.on_host(), run, led, now.scan_seconds);
      if (led) now.method = "pseudo-hull";
      return filtered;
    }
    Filtered filtered;
    if (follows(points) && wants_gauge(points) &&
        filter_by_leaders(points, *hull, sorted(hull->vertices), run, filtered, now.scan_seconds)) {
      now.method = "gauge";
      // The leaders did not help, and cost a pass: pause for some frames, at most 16, so that a new
      // attempt costs at most a sixteenth of the time.
      if (filtered.pass_survivors > points.count / 3 ||
          (is_small(points) && filtered.survivors.size(points.count) > left_afresh / 2)) {
        pause = penalty;
        penalty = std::min<std::uint64_t>((is_small(points) ? 4 : 2) * penalty, 16);
      } else {
        penalty = 1;
      }
      return filtered;
    }
    if (pause > 0) --pause;
    filtered = points.filter_afresh();
    if (filtered.moved) now.method = "pseudo-hull";
    left_afresh = filtered.survivors.size(points.count);
    return filtered;
  }

  /// Processes one frame. `few` may compute its hull at once; else `points_of` creates its
  /// FramePoints.
  template <class Few, class PointsOf>
  const Hull& compute_next(const Few& few, const PointsOf& points_of) {
    const std::uint64_t index = frame++;
    try {
      const Clock::time_point start = Clock::now();
      if (compared) before = nullptr;  // frees memory for the next hull
      FrameReport now;
      now.index = index;
      const auto next = std::make_shared<Hull>();
      if (few(*next)) {
        take_few(next, now);
        return *hull;
      }
      const Call call(options);
      compute(*points_of(call.run), call.run, now, start, next);
    } catch (const Error& e) {
      if (e.code() == ErrorCode::cancelled) throw;
      throw Error(e.code(), "frame ", index, ": ", e.what());
    }
    return *hull;
  }

  void compute(FramePoints& points, const Run& run, FrameReport& now, Clock::time_point start,
               const std::shared_ptr<Hull>& next) {
    run.control.check();
    Filtered filtered = filter(points, run, now);
    now.scan_survivors = filtered.pass_survivors;
    now.survivors = filtered.survivors.size(points.count);
    now.cull_seconds = seconds_since(start);
    Survivors left = filtered.survivors;
    const bool tries = follows(points) && surface_pause == 0;
    if (surface_pause > 0) --surface_pause;
    if (tries) points.known.hull = hull.get();
    if (numbers) points.known.numbers = &*numbers;
    before = nullptr;  // a third hull would be out of the cache: 1 to 3 % of a frame on a sphere
    compared = true;
    *next = points.hull(std::move(filtered));
    if (points.known.holds || points.known.mended) {
      surface_penalty = least_surface_penalty;
      // The new hull has the same triangles.
      if (points.known.holds && !numbers) numbers.emplace(*next);
    } else if (points.known.tried) {  // it cost up to a tenth of the frame
      surface_pause = surface_penalty;
      surface_penalty = std::min<std::uint64_t>(2 * surface_penalty, 32);
    }
    now.hull_seconds = next->statistics.hull_seconds;
    now.compute_seconds = seconds_since(start);
    next->statistics.cull_seconds = now.cull_seconds;
    next->statistics.compute_seconds = now.compute_seconds;
    if (!points.known.holds) numbers.reset();
    take(next, std::move(left), now);
    run.control.report("done", 1);
  }

  /// Stores a hull that needed no filter and no threads, as compute_next() does for others.
  void take_few(const std::shared_ptr<Hull>& next, FrameReport& now) {
    now.scan_survivors = now.survivors = next->point_count;
    now.hull_seconds = next->statistics.hull_seconds;
    now.compute_seconds = next->statistics.compute_seconds;
    Survivors all;
    all.all = true;
    all.reason = next->statistics.cull_reason;
    numbers.reset();
    take(next, std::move(all), now);
  }

  void take(const std::shared_ptr<Hull>& next, Survivors&& left, const FrameReport& now) noexcept {
    const bool follows =
        known && hull->point_count == next->point_count && hull->dimension == next->dimension;
    before = follows ? std::move(hull) : nullptr;
    hull = next;
    survivors = std::move(left);
    report = now;
    compared = false;
    known = true;
  }

  const FrameReport& compare() {
    if (!compared) count_changes(before == nullptr ? Hull() : *before, *hull, report);
    compared = true;
    return report;
  }
};

HullTracker::HullTracker(Options options) : impl_(std::make_unique<Impl>()) {
  impl_->options = std::move(options);
}
HullTracker::HullTracker(HullTracker&&) noexcept = default;
HullTracker& HullTracker::operator=(HullTracker&&) noexcept = default;
HullTracker::~HullTracker() = default;

const Hull& HullTracker::update(const PointView& points) {
  const Options& options = impl_->options;
  return impl_->compute_next(
      [&](Hull& hull) {
    check_arguments(points, options);
    return small_hull(points, options, hull);
      },
      [&](const Run& run) { return std::make_unique<HostFrame>(points, run); });
}

const Hull& HullTracker::update(const DevicePointView& points) {
  return impl_->compute_next(
      [](Hull&) { return false; },
      [&](const Run& run) { return device_frame(points, run, impl_->surface); });
}

const Hull& HullTracker::hull() const noexcept { return *impl_->hull; }
std::shared_ptr<const Hull> HullTracker::shared_hull() const noexcept { return impl_->hull; }
const FrameReport& HullTracker::report() const { return impl_->compare(); }
const Survivors& HullTracker::survivors() const noexcept { return impl_->survivors; }

void HullTracker::reset() noexcept {
  impl_->known = false;
  impl_->frame = 0;
  impl_->pause = 0;
  impl_->penalty = 1;
  impl_->left_afresh = 0;
  impl_->numbers.reset();
  impl_->surface_pause = 0;
  impl_->surface_penalty = least_surface_penalty;
  impl_->simplices.clear();
  impl_->surface.reset();
}

}  // namespace cullhull
