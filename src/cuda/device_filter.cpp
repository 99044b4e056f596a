#include <string>
#include <utility>
#include <vector>

#include "cuda/device_rows.hpp"
#include "cuda/gauge.hpp"
#include "cuda/kernels/gauge_kernel.hpp"
#include "cuda/kernels/pseudo_hull.hpp"
#include "cuda/kernels/star_hull.hpp"
#include "cuda/runtime.hpp"
#include "filter/planner.hpp"
#include "filter/ways.hpp"
#include "flow/pipeline.hpp"
#include "flow/sample_map.hpp"
#include "geometry/gather.hpp"
#include "parallel/threads/run.hpp"

namespace cullhull::internal {
namespace {

/// Filters points in a device's memory, there or on the host, and copies the survivors to the host.
class DeviceFilter {
 public:
  DeviceFilter(const DevicePointView& points, const Run& run, std::shared_ptr<LastSurface>* last)
      : points_(points),
        run_(run),
        last_(last),
        forced_(run.options.cull == CullMethod::gauge),
        d_(points.dimension) {}

  Filtered run() {
    try {
      return cull_there_or_here();
    } catch (const OutOfMemory& e) {
      if (run_.options.backend == Backend::cuda) throw;
      return culled_on_host(e.what());  // downloading packed points needs no device memory
    }
  }

 private:
  /// Chooses the filter and where it runs, as the options and the planner decide.
  Filtered cull_there_or_here() {
    Filtered result;
    result.survivors.all = true;
    if (run_.options.cull == CullMethod::pseudo_hull && run_.options.backend != Backend::cpu &&
        d_ <= pseudo_hull_cuda_max_dimension &&
        takes(Way::pseudo_hull, way_question(points_, run_.options)))
      return pseudo_hull_there();
    if (run_.options.cull == CullMethod::pseudo_hull) return culled_on_host("");
    result.survivors.reason = why_no_filter(way_question(points_, run_.options));
    if (!result.survivors.reason.empty()) return all_points(std::move(result));
    if (run_.options.backend == Backend::cpu) return culled_on_host("");
    std::string where = "CUDA device as asked";
    if (run_.options.backend == Backend::automatic) {
      const Placement place = place_of_device_points(points_, run_);
      if (!place.device) return culled_on_host(place.reason);
      where = place.reason;
    }
    run_.report("cull", 0);
    // Leaders of all points cull what a map would, without a sample and its hull on the CPU; where
    // some directions have no point, a map is better than a simplex.
    if (!forced_ &&
        hull_of_all_there(where, last_ == nullptr ? StarBegin::leaders : StarBegin::any, result))
      return result;
    const SampledMap sampled = first_map();
    result.survivors.reason += sampled.reason;
    if (sampled.map == nullptr)
      return hull_of_all_there(where, StarBegin::any, result) ? std::move(result)
                                                              : all_points(std::move(result));
    result.survivors.reason += "; " + where;
    result.survivors.backend = Backend::cuda;
    result.survivors.filter = UsedFilter::gauge;
    result.survivors.all = false;
    try {
      cull_there(sampled.map->table(), result);
      return result;
    } catch (const OutOfMemory&) {
      result.survivors.reason += "; its memory is nearly full";
      result.survivors.filter = UsedFilter::gauge;
      result.triangles = {};  // of points that are not the survivors now
    }
    cull_by_pieces(sampled.map->table(), result);
    return result;
  }

  /// Filters all points by a pseudo-hull on the device. A second filter is not needed.
  Filtered pseudo_hull_there() const {
    run_.report("cull", 0);
    Filtered result;
    std::vector<std::uint64_t> ids = pseudo_hull_survivors_cuda(points_, {}, run_.control);
    fetch_rows(ids, result);
    result.survivors.all = ids.size() == points_.count;
    if (!result.survivors.all) result.survivors.ids = std::move(ids);
    result.survivors.filter = UsedFilter::pseudo_hull;
    result.survivors.backend = Backend::cuda;
    result.survivors.reason = "filter as asked; the points are on the device";
    return result;
  }

  /// Looks for the hull's surface among all points; false if that is not worthwhile, or there is
  /// none. What is not finite is not culled, and found when the rest is copied.
  bool hull_of_all_there(const std::string& where, StarBegin begin, Filtered& result) const {
    if (!surface_of_all_pays(points_, run_)) return false;
    std::string& reason = result.survivors.reason;
    try {
      StarHullThere found = star_hull_there(points_, run_, {.begin = begin, .last = last_});
      if (found.counts.end.facets == 0) return false;
      reason += (reason.empty() ? "" : "; ") + where +
                (found.counts.moved ? "; the last frame's pseudo-hull, " : "; a pseudo-hull, ") +
                described(found.counts);
      result.moved = found.counts.moved;
      result.survivors.filter = UsedFilter::pseudo_hull;
      result.survivors.backend = Backend::cuda;
      result.survivors.all = found.ids.count == points_.count;
      result.triangles = std::move(found.triangles);
      if (result.survivors.all) {
        result = all_points(std::move(result));
      } else {
        const DeviceArray<std::byte> rows = rows_of(points_, found.ids);
        copy_survivors(packed(rows, found.ids.count), found.ids, result);
      }
      return true;
    } catch (const OutOfMemory&) {
      if (begin == StarBegin::any && run_.options.backend == Backend::cuda) throw;
      reason += (reason.empty() ? "" : "; ") + std::string("the device's memory is nearly full; ");
      result.triangles = {};
      result.moved = false;
    }
    return false;
  }

  /// Copies the rows of these points to the host.
  void fetch_rows(std::span<const std::uint64_t> ids, Filtered& result) const {
    require_room_for_survivors(ids.size(), d_, run_);
    result.rows = download_finite(points_, ids.data(), ids.size(), ids.data(), run_);
  }

  /// Copies ids and rows (`view`) to the host.
  void copy_survivors(const DevicePointView& view, const DeviceIds& left, Filtered& result) const {
    require_room_for_survivors(left.count, d_, run_);
    std::vector<std::uint64_t> ids(left.count);
    download(ids.data(), left.ids.data(), left.count, cuda_stream_of(points_));
    result.rows = download_finite(view, nullptr, left.count, ids.data(), run_);
    result.survivors.ids = std::move(ids);
  }

  /// Copies all points to the host if no filter is worthwhile.
  Filtered all_points(Filtered&& result) const {
    result.rows = download_all(points_, run_);
    return std::move(result);
  }

  /// Copies all points to the host and filters them there. `why` completes the reason reported.
  Filtered culled_on_host(const std::string& why) const {
    Array<double> rows = download_all(points_, run_);
    const PointView view = PointView::row_major(rows.data(), points_.count, d_);
    Options options = run_.options;
    options.backend = Backend::cpu;
    Filtered result = run_filter(view, Run(options));
    if (!why.empty()) result.survivors.reason += "; " + why;
    if (result.survivors.all)
      result.rows = std::move(rows);
    else if (result.rows.empty())
      result.rows =
          gather_points(view, result.survivors.ids.data(), result.survivors.ids.size(), run_);
    return result;
  }

  /// Some of all points. Refused is the first point of all that is not finite, not the first of a
  /// sample.
  SampledPoints sampled(const DevicePointView& points) const {
    return {points.count, d_, [this, points](std::span<const std::uint64_t> ids) {
              return gather_from_device(points, ids, points_, run_);
            }};
  }

  /// The map of a sample of all points. In 2D and 3D a pseudo-hull follows, which needs no large
  /// sample. In 3D, of 100M points of a ball, the map of a probe leaves 6 %, that of four times as
  /// many points 2 %; each point left costs the surface's growth 1.2 ns, and the larger sample's
  /// hull takes 0.6 ms (H200): as much at 16M points.
  SampledMap first_map() const {
    return map_of_sample(sampled(points_), forced_ ? Insist::yes : Insist::no,
                         most_gauge_nodes(this_device()), run_,
                         d_ == 3         ? 1
                         : grows_later() ? 4
                                         : ~std::uint64_t{0});
  }

  /// Whether a pseudo-hull instead of a second map filters the survivors of the first map. It needs
  /// neither CPU nor sample, so the first map may come from a smaller sample and keep more points.
  /// Of 8M points in a ball in 3D it leaves 47,169 where a second map leaves 79,161; in 2D it
  /// leaves only the hull's vertices. From 4D on it leaves more points than a second map.
  bool grows_later() const { return d_ <= 3; }

  /// What flips made of a star-shaped surface, in words.
  static std::string described(const StarCounts& counts) {
    if (counts.end.facets == 0) return "which has no simplex";
    if (counts.whole()) return "which flips made convex";
    return "with " + std::to_string(counts.aside) + " points aside and " +
           std::to_string(counts.end.reflex + counts.end.uncertain) +
           " edges that flips did not make convex";
  }

  /// The indices of the rows of `view` that the second filter keeps. Null ids if a second filter is
  /// not worthwhile: all rows stay.
  DeviceIds kept_of(const DevicePointView& view, Filtered& result) const {
    // Points in a ball take 13 to 16 rounds. Points still outside the pseudo-hull after 24 rounds
    // survive.
    constexpr unsigned most_rounds = 24;
    if (grows_later() && view.count > pseudo_hull_most_points) return {};
    if (d_ == 3) {
      StarHullThere found = star_hull_there(view, run_, {});
      result.survivors.filter = UsedFilter::gauge_pseudo_hull;
      result.survivors.reason += "; a pseudo-hull of what it left, " + described(found.counts);
      result.triangles = std::move(found.triangles);
      return std::move(found.ids);
    }
    if (grows_later()) {
      DeviceIds kept = pseudo_hull_survivors_there(view, most_rounds, run_.control);
      result.survivors.filter = UsedFilter::gauge_pseudo_hull;
      result.survivors.reason += "; a pseudo-hull of what it left";
      return kept;
    }
    const SampledMap finer =
        map_of_sample(sampled(view), Insist::late, most_gauge_nodes(this_device()), run_);
    result.survivors.reason += "; a second map: " + finer.reason;
    if (finer.map == nullptr) return {};
    result.survivors.filter = UsedFilter::gauge_twice;
    return survivors_of_device_points(finer.map->table(), view);
  }

  /// The usual case: both filters run on the device, and only the survivors of the second are
  /// copied to the host.
  void cull_there(const GaugeTable& table, Filtered& result) const {
    const cudaStream_t stream = cuda_stream_of(points_);
    DeviceIds left = survivors_of_device_points(table, points_);
    require_room_for_survivors(left.count, d_, run_);
    DeviceArray<std::byte> rows = rows_of(points_, left);
    DevicePointView view = packed(rows, left.count);
    run_.report("cull", 0.8);
    if (left.count >= smallest_worth_refining(d_)) {
      const DeviceIds kept = kept_of(view, result);
      if (kept.ids.data() != nullptr) {
        DeviceIds ids;
        ids.count = kept.count;
        ids.ids = DeviceArray<std::uint64_t>(kept.count, stream);
        check(gather_ids(left.ids.data(), kept.ids.data(), kept.count, ids.ids.data(), stream),
              "gathering ids");
        DeviceArray<std::byte> fewer = rows_of(view, kept);
        rows = std::move(fewer);
        left = std::move(ids);
        view = packed(rows, left.count);
      }
    }
    copy_survivors(view, left, result);
  }

  /// Gathers the rows of some points on the device.
  DeviceArray<std::byte> rows_of(const DevicePointView& points, const DeviceIds& which) const {
    const cudaStream_t stream = cuda_stream_of(points_);
    DeviceArray<std::byte> rows(which.count * d_ * scalar_size(points_.scalar), stream);
    check(gather_rows(points, which.ids.data(), which.count, rows.data(), stream),
          "gathering points");
    return rows;
  }

  DevicePointView packed(const DeviceArray<std::byte>& rows, std::uint64_t count) const {
    DevicePointView view = points_;
    view.data = rows.data();
    view.count = count;
    view.coordinate_stride = static_cast<std::ptrdiff_t>(scalar_size(points_.scalar));
    view.point_stride = view.coordinate_stride * static_cast<std::ptrdiff_t>(d_);
    return view;
  }

  /// The case of hardly any free device memory: the survivors of the first map are copied to the
  /// host, and the second filter runs there.
  void cull_by_pieces(const GaugeTable& table, Filtered& result) const {
    const Array<std::uint64_t> ids = survivors_by_pieces(table, points_, run_.control);
    fetch_rows(ids, result);
    result.survivors.ids.assign(ids.begin(), ids.end());
    refine_survivors(result, d_, run_);
  }

  const DevicePointView& points_;
  const Run& run_;
  std::shared_ptr<LastSurface>* last_;  ///< of a tracker, or null
  bool forced_;
  unsigned d_;
};

}  // namespace

Filtered run_device_filter(const DevicePointView& points, const Run& run,
                           std::shared_ptr<LastSurface>* last) {
  if (points.count == 0) {
    (void)this_device();
    Filtered nothing;
    nothing.survivors.all = true;
    nothing.survivors.reason = "no points";
    return nothing;
  }
  // Uses the device that holds the points, which may be the only usable one.
  const int ordinal = device_of(points);
  (void)device(ordinal);
  const DeviceScope scope(ordinal);
  return DeviceFilter(points, run, last).run();
}

}  // namespace cullhull::internal
