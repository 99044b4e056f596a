#include <algorithm>
#include <optional>
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
#include "parallel/threads/run.hpp"

namespace cullhull::internal {
namespace {

/// What filters leave of all points, in the device's memory.
struct Kept {
  DeviceIds ids;
  DeviceArray<std::byte> rows;
};

/// Fewest points left by a map that a pseudo-hull culls on the device. With the CPU's limit for a
/// second map, 29,473, a ball of 2^17 points took 5.0 ms, some 0.22 us for each of the 18,000 left,
/// and one of 2^18, with a pseudo-hull of twice as many, 3.4 ms (H200). So a small pseudo-hull
/// takes about 1 ms, the CPU's time for some 4,000 points (derived, not measured).
constexpr std::uint64_t least_grown = 4000;

/// Filters points in a device's memory, there or on the host.
class DeviceFilter {
 public:
  DeviceFilter(const DevicePointView& points, const Run& run, const DeviceRequest& request)
      : points_(points),
        run_(run),
        request_(request),
        place_(!request.hull              ? HullPlace::nowhere
               : request.there == nullptr ? HullPlace::host
                                          : HullPlace::device),
        d_(points.dimension) {}

  /// Also copies the survivors to the host.
  Filtered run() {
    try {
      return cull_there_or_here();
    } catch (const OutOfMemory& e) {
      if (run_.options.backend == Backend::cuda) throw;
      return left_to_cpu(e.what());  // downloading packed points needs no device memory
    }
  }

  /// What a map and, if it is `refined`, a second filter leave, both on the device; without a map,
  /// what the hull's surface of all points leaves. None: all points stay. `where`: why on the
  /// device.
  std::optional<Kept> kept_by(const GaugeMap* map, bool refined, const std::string& where,
                              Filtered& result) const {
    if (map == nullptr && !surface_of_all_pays(d_, points_.count, run_)) return {};
    result.survivors.reason += "; " + where;
    return map != nullptr ? kept_by_map(*map, refined, result)
                          : kept_by_surface(StarBegin::any, result);
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
    if (run_.options.cull == CullMethod::pseudo_hull) return left_to_cpu("");
    result.survivors.reason = why_no_filter(way_question(points_, run_.options));
    const bool must = run_.options.backend == Backend::cuda;
    if (run_.options.backend == Backend::cpu || (!must && !result.survivors.reason.empty()))
      return left_to_cpu("");
    if (!result.survivors.reason.empty()) return all_points(std::move(result));
    std::string where = "CUDA device as asked";
    if (run_.options.backend == Backend::automatic) {
      const Placement place = place_of_device_points(points_, run_);
      if (!place.device) return left_to_cpu(place.reason);
      where = place.reason;
    }
    run_.report("cull", 0);
    if (run_.options.cull != CullMethod::gauge && hull_of_all_there(where, result)) return result;
    const SampledMap sampled = map_of_sample(
        sampled_points(points_), run_.options.cull == CullMethod::gauge ? Insist::yes : Insist::no,
        most_map_nodes(), run_, most_probes_of_device(d_));
    result.survivors.reason = sampled.reason;
    const Survivors before = result.survivors;
    try {
      const std::optional<Kept> kept = kept_by(sampled.map.get(), !sampled.of_all, where, result);
      if (!kept) return all_points(std::move(result));
      copy_survivors(*kept, result);
      return result;
    } catch (const OutOfMemory&) {
      if (sampled.map == nullptr && must) throw;
      result = {};
      result.survivors = before;
      result.survivors.reason += "; " + where + "; its memory is nearly full";
    }
    if (sampled.map == nullptr) return all_points(std::move(result));
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

  /// Leaders of all points cull what a map would, without a sample and its hull on the CPU. False
  /// where some directions have no point, for which a map is better than a simplex, and where the
  /// device's memory does not suffice.
  bool hull_of_all_there(const std::string& where, Filtered& result) const {
    if (!surface_of_all_pays(d_, points_.count, run_)) return false;
    try {
      Filtered found;
      found.survivors.reason = where;
      const std::optional<Kept> kept =
          kept_by_surface(begins_anyhow() ? StarBegin::any : StarBegin::leaders, found);
      if (found.survivors.filter != UsedFilter::pseudo_hull) return false;
      if (!kept)
        found = all_points(std::move(found));
      else
        copy_survivors(*kept, found);
      found.pass_survivors = found.survivors.size(points_.count);
      result = std::move(found);
      return true;
    } catch (const OutOfMemory&) {
      return false;
    }
  }

  /// A surface that later frames begin with is worth a simplex, unless the last one was not whole.
  bool begins_anyhow() const {
    return request_.last != nullptr && (*request_.last == nullptr || (*request_.last)->kept);
  }

  /// What is not finite is not culled, and found when the rest is copied. None: all points stay, as
  /// vertices of the surface, or because there is none.
  std::optional<Kept> kept_by_surface(StarBegin begin, Filtered& result) const {
    StarHullThere found = star_hull_there(
        points_, run_,
        {.place = place_, .rows = request_.rows, .begin = begin, .last = request_.last});
    if (found.counts.end.facets == 0) return {};
    result.survivors.reason +=
        (found.counts.moved ? "; the last frame's pseudo-hull, " : "; a pseudo-hull, ") +
        described(found.counts);
    result.moved = found.counts.moved;
    result.survivors.filter = UsedFilter::pseudo_hull;
    result.survivors.backend = Backend::cuda;
    result.survivors.all = found.ids.count == points_.count;
    if (!result.survivors.all)
      result.survivors.ids.assign(found.lists.rows.begin(), found.lists.rows.end());
    if (take_hull(found, found.ids, result)) return Kept{std::move(found.ids), {}};
    if (result.survivors.all) return {};
    DeviceArray<std::byte> rows = rows_of(points_, found.ids);
    return Kept{std::move(found.ids), std::move(rows)};
  }

  /// Takes the hull of what was found, if there is one, and leaves it there if that is wanted.
  /// False if the vertices' rows are still to be copied.
  bool take_hull(StarHullThere& found, const DeviceIds& ids, Filtered& result) const {
    const bool left = found.left != nullptr;
    if (left) leave_there(found, ids, cuda_stream_of(points_), *request_.there);
    result.triangles = std::move(found.lists.triangles);
    result.rows = std::move(found.lists.coordinates);
    return left || !result.triangles.empty();
  }

  /// Copies the rows of these points to the host.
  void fetch_rows(std::span<const std::uint64_t> ids, Filtered& result) const {
    require_room_for_survivors(ids.size(), d_, run_);
    result.rows = download_finite(points_, ids.data(), ids.size(), ids.data(), run_);
  }

  /// Nothing where the hull is known.
  void copy_survivors(const Kept& kept, Filtered& result) const {
    if (kept.rows.data() == nullptr) return;
    const std::uint64_t count = kept.ids.count;
    require_room_for_survivors(count, d_, run_);
    std::vector<std::uint64_t> ids;
    kept.ids.append_to(ids, 0, cuda_stream_of(points_));
    result.rows = download_finite(packed(kept.rows, count), nullptr, count, ids.data(), run_);
    result.survivors.ids = std::move(ids);
  }

  /// Copies all points to the host if no filter is worthwhile.
  Filtered all_points(Filtered&& result) const {
    result.rows = download_all(points_, run_);
    return std::move(result);
  }

  /// Copies all points to the host, whose filters are the CPU's. `why` completes the reason.
  Filtered left_to_cpu(const std::string& why) const {
    Filtered result;
    result.on_host = true;
    result.survivors.all = true;
    result.survivors.reason = why;
    return all_points(std::move(result));
  }

  /// Fetches samples of `points`; from 4D on the device finds the leaders of all. The first of all
  /// points that is not finite is refused, not the first of a sample.
  SampledPoints sampled_points(const DevicePointView& points) const {
    SampledPoints sampled{points.count, d_, [this, points](std::span<const std::uint64_t> ids) {
                            return gather_from_device(points, ids, points_, run_);
                          }};
    if (d_ >= 4 && points.count <= pseudo_hull_most_points)
      sampled.lead = [this, points](const GaugeMap& before, const LeaderCells& cells) {
        return map_of_leaders(points, before, cells);
      };
    return sampled;
  }

  /// The device finds the outermost points of all, the CPU makes the map of these few rows. Null
  /// where half of the directions have no points, as in a scan, and where the device's memory does
  /// not suffice.
  std::unique_ptr<GaugeMap> map_of_leaders(const DevicePointView& points, const GaugeMap& before,
                                           LeaderCells cells) const {
    cells.filled = 0.5;
    try {
      run_.check();
      const DeviceIds ids = outermost_there(before.table(), cells.leaders, points);
      const DeviceArray<std::byte> rows = rows_of(points, ids);
      return GaugeMap::of_leaders(
          download_points(packed(rows, ids.count), nullptr, ids.count, run_), before, cells, run_);
    } catch (const OutOfMemory&) {
      return nullptr;
    }
  }

  /// What flips made of a star-shaped surface, in words.
  static std::string described(const StarCounts& counts) {
    if (counts.end.facets == 0) return "which has no simplex";
    if (counts.whole()) return "which flips made convex";
    return "with " + std::to_string(counts.aside) + " points aside and " +
           std::to_string(counts.end.reflex + counts.end.uncertain) +
           " edges that flips did not make convex";
  }

  /// The indices of the rows of `view` that the second filter keeps; in space also the surface that
  /// it `found`. Null ids if a second filter is not worthwhile: all rows stay.
  DeviceIds kept_of(const DevicePointView& view, const GaugeMap& first, Filtered& result,
                    StarHullThere& found) const {
    // Points in a ball take 13 to 16 rounds. Points still outside the pseudo-hull after 24 rounds
    // survive.
    constexpr unsigned most_rounds = 24;
    // Of 8M points in a ball in 3D a pseudo-hull leaves 47,169 where a second map leaves 79,161; in
    // 2D it leaves only the hull's vertices. From 4D on it leaves more points than a second map.
    if (d_ <= 3 && view.count > pseudo_hull_most_points) return {};
    if (d_ == 3) {
      found = star_hull_there(view, run_, {.place = place_, .rows = request_.rows});
      result.survivors.filter = UsedFilter::gauge_pseudo_hull;
      result.survivors.reason += "; a pseudo-hull of what it left, " + described(found.counts);
      return std::move(found.ids);
    }
    if (d_ == 2) {
      DeviceIds kept = pseudo_hull_survivors_there(view, most_rounds, run_.control);
      result.survivors.filter = UsedFilter::gauge_pseudo_hull;
      result.survivors.reason += "; a pseudo-hull of what it left";
      return kept;
    }
    const SampledMap finer = map_of_left(sampled_points(view), &first, most_map_nodes(), run_);
    result.survivors.reason += "; a second map: " + finer.reason;
    if (finer.map == nullptr) return {};
    result.survivors.filter = UsedFilter::gauge_twice;
    return survivors_of_device_points(finer.map->table(), view);
  }

  Kept kept_by_map(const GaugeMap& map, bool refined, Filtered& result) const {
    result.survivors.backend = Backend::cuda;
    result.survivors.filter = UsedFilter::gauge;
    result.survivors.all = false;
    Kept kept;
    kept.ids = survivors_of_device_points(map.table(), points_);
    require_room_for_survivors(kept.ids.count, d_, run_);
    kept.rows = rows_of(points_, kept.ids);
    run_.report("cull", 0.8);
    if (!refined || kept.ids.count < (d_ <= 3 ? least_grown : smallest_worth_refining(d_)))
      return kept;
    const DevicePointView view = packed(kept.rows, kept.ids.count);
    StarHullThere found;
    const DeviceIds second = kept_of(view, map, result, found);
    if (second.ids.data() == nullptr) return kept;
    const cudaStream_t stream = cuda_stream_of(points_);
    Kept fewer;
    fewer.ids = {DeviceArray<std::uint64_t>(second.count, stream), second.count};
    check(gather_ids(kept.ids.ids.data(), second.ids.data(), second.count, fewer.ids.ids.data(),
                     stream),
          "gathering ids");
    if (!take_hull(found, fewer.ids, result)) {
      fewer.rows = rows_of(view, second);
    } else if (!result.rows.empty()) {
      fewer.ids.append_to(result.survivors.ids, 0, stream);
    }
    return fewer;
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
    result.survivors.backend = Backend::cuda;
    result.survivors.filter = UsedFilter::gauge;
    result.survivors.all = false;
    const Array<std::uint64_t> ids = survivors_by_pieces(table, points_, run_.control);
    fetch_rows(ids, result);
    result.survivors.ids.assign(ids.begin(), ids.end());
    refine_survivors(result, d_, run_);
  }

  const DevicePointView& points_;
  const Run& run_;
  const DeviceRequest& request_;
  const HullPlace place_;
  const unsigned d_;
};

}  // namespace

Filtered run_device_filter(const DevicePointView& points, const Run& run,
                           const DeviceRequest& request) {
  if (points.count == 0) {
    (void)this_device();
    Filtered nothing;
    nothing.survivors.all = true;
    nothing.survivors.reason = "no points";
    return nothing;
  }
  const DeviceScope scope(device_of(points), run.options);  // it may be the only usable one
  return DeviceFilter(points, run, request).run();
}

void filter_there(const PointView& points, const GaugeMap* map, const std::string& where,
                  const Run& run, Filtered& result) {
  const std::vector<int> devices = devices_for(run.options.device);
  if (map == nullptr && !surface_of_all_pays(points.dimension, points.count, run)) return;
  // Without a map a part may leave all of its points, as on a sphere: one device has them all.
  constexpr std::uint64_t least = std::uint64_t{1} << 16;  // for a part: fewer take no time
  const std::uint64_t parts =
      map == nullptr ? 1 : std::clamp<std::uint64_t>(points.count / least, 1, devices.size());
  Options of_part = run.options;
  of_part.threads = run.threads;
  of_part.memory_budget = run.budget;
  if (parts > 1) of_part.progress = {};  // a part may be another thread's
  const Run part_run(of_part);
  std::vector<std::vector<std::uint64_t>> left(parts);
  std::vector<Filtered> found(parts);
  run.each_item(parts, [&](std::uint64_t p) {
    const DeviceScope scope(devices[p], of_part);
    const std::uint64_t begin = points.count * p / parts,
                        count = points.count * (p + 1) / parts - begin;
    const auto filter = [&](std::uint64_t first, std::uint64_t n) {
      const CudaStream stream;
      const Settled settled(stream.get());  // an allocator may know the memory by the stream
      DevicePointView there;
      const DeviceArray<std::byte> rows =
          uploaded_points(points, begin + first, n, stream.get(), part_run, there);
      found[p] = {};
      found[p].survivors.all = true;
      found[p].survivors.reason = result.survivors.reason;
      const DeviceRequest request{.hull = n == points.count, .rows = false};
      const std::optional<Kept> kept =
          DeviceFilter(there, part_run, request).kept_by(map, true, where, found[p]);
      if (!kept || found[p].survivors.all) return;
      kept->ids.append_to(left[p], begin + first, stream.get());
      if (n != count) found[p].survivors.reason += "; in pieces that fit its memory";
    };
    if (map != nullptr)
      in_pieces(count, count, part_run.control, filter);
    else
      filter(0, count);
  });
  result.survivors = std::move(found[0].survivors);
  if (parts > 1) result.survivors.reason += "; on " + std::to_string(parts) + " devices";
  for (const auto& ids : left)
    result.survivors.ids.insert(result.survivors.ids.end(), ids.begin(), ids.end());
  result.triangles = std::move(found[0].triangles);
}

}  // namespace cullhull::internal
