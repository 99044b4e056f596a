// Times of a device's steps for each kind of points: gpu_passes [--out FILE] [--scale S] [--seconds
// T]
//
// Prints one JSON object per line as soon as it is measured, and appends it to FILE, so that an
// interrupted run reports what it has done. A kernel's time is a tenth of that of ten calls between
// two events of their stream; the stages of a whole call are the times between events at their
// borders; everything else is timed by the host's clock. Medians of five after a first run that is
// not counted. Parts that do not fit into the device's memory, or would start after T seconds, are
// skipped and reported as skipped. Exit status 5: no device.
#include <cuda_runtime_api.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "cuda/gauge.hpp"
#include "cuda/hull_questions.hpp"
#include "cuda/kept_tables.hpp"
#include "cuda/kernels/gauge_kernel.hpp"
#include "cuda/kernels/hull_questions_kernel.hpp"
#include "cuda/kernels/pseudo_hull.hpp"
#include "cuda/kernels/set_hulls_kernel.hpp"
#include "cuda/kernels/star_hull.hpp"
#include "cuda/runtime.hpp"
#include "cullhull/cullhull.hpp"
#include "cullhull/device_hull.hpp"
#include "cullhull/device_points.hpp"
#include "cullhull/generate.hpp"
#include "filter/gauge/gauge_map.hpp"
#include "filter/planner.hpp"
#include "flow/pipeline.hpp"
#include "flow/sample_map.hpp"
#include "geometry/gather.hpp"
#include "json_lines.hpp"
#include "query/device_questions.hpp"
#include "query/facet_search.hpp"

namespace {

using namespace cullhull::internal;
using namespace cullhull;
using nlohmann::ordered_json;

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

double median(std::vector<double> times) {
  std::sort(times.begin(), times.end());
  return times[times.size() / 2];
}

/// Timed runs, and calls between two events; a run of smaller sets, which is a test, makes fewer.
unsigned repeats = 5, calls = 10;

double wall(const std::function<void()>& work) {
  work();
  std::vector<double> times;
  for (unsigned k = 0; k < repeats; ++k) {
    const auto start = Clock::now();
    work();
    times.push_back(seconds_since(start));
  }
  return median(times);
}

/// Seconds between two events of a stream around the work that `work` queues on it.
double between_events(cudaStream_t stream, const std::function<void()>& work) {
  cudaEvent_t begin = nullptr, end = nullptr;
  check(cudaEventCreate(&begin), "making an event");
  check(cudaEventCreate(&end), "making an event");
  check(cudaEventRecord(begin, stream), "recording an event");
  work();
  check(cudaEventRecord(end, stream), "recording an event");
  check(cudaEventSynchronize(end), "waiting for an event");
  float milliseconds = 0;
  check(cudaEventElapsedTime(&milliseconds, begin, end), "reading an event");
  (void)cudaEventDestroy(begin);
  (void)cudaEventDestroy(end);
  return 1e-3 * milliseconds;
}

/// Time of the work that a call of `work` queues on the stream: several calls between two events,
/// so that the time of a launch and the clock's step of half a microsecond do not count.
double by_events(cudaStream_t stream, const std::function<void()>& work) {
  const auto several = [&] {
    for (unsigned k = 0; k < calls; ++k) work();
  };
  std::vector<double> times;
  (void)between_events(stream, several);
  for (unsigned k = 0; k < repeats; ++k) times.push_back(between_events(stream, several) / calls);
  return median(times);
}

/// Points uniform in the ball.
template <class T>
std::vector<T> ball(unsigned d, std::uint64_t n) {
  const std::vector<double> rows = generate("ball", n, d);
  return {rows.begin(), rows.end()};
}

/// The stages of a call that is made several times: each ends at an event of the stream. The host
/// waits for the stream at the end of each, so that a stage of the CPU lasts from event to event,
/// too.
class Stages {
 public:
  explicit Stages(cudaStream_t stream) : stream_(stream) {}
  ~Stages() {
    for (const Mark& m : marks_) (void)cudaEventDestroy(m.event);
  }
  Stages(const Stages&) = delete;
  Stages& operator=(const Stages&) = delete;

  void begin() { mark(""); }
  /// The stage that ends here.
  void end(const char* name) { mark(name); }

  /// The median of each stage over the calls but the first; a stage that occurs twice in a call
  /// counts with its sum. In the order in which they end, and last their sum.
  ordered_json medians() {
    check(cudaStreamSynchronize(stream_), "waiting for a stream");
    std::vector<std::string> order;
    std::map<std::string, std::vector<double>> times;
    unsigned call = 0;
    for (std::size_t i = 0; i < marks_.size(); ++i) {
      const std::string& name = marks_[i].name;
      if (name.empty()) {
        ++call;
        continue;
      }
      float milliseconds = 0;
      check(cudaEventElapsedTime(&milliseconds, marks_[i - 1].event, marks_[i].event),
            "reading an event");
      std::vector<double>& of = times[name];
      if (of.empty()) order.push_back(name);
      of.resize(call);
      of[call - 1] += 1e-3 * milliseconds;
    }
    ordered_json json;
    double sum = 0;
    for (const std::string& name : order) {
      const std::vector<double>& of = times[name];
      const double seconds = median({of.begin() + (of.size() > 1 ? 1 : 0), of.end()});
      json[name] = seconds;
      sum += seconds;
    }
    json["sum"] = sum;
    return json;
  }

 private:
  struct Mark {
    std::string name;
    cudaEvent_t event;
  };

  void mark(const char* name) {
    check(cudaStreamSynchronize(stream_), "waiting for a stream");
    cudaEvent_t event = nullptr;
    check(cudaEventCreate(&event), "making an event");
    marks_.push_back({name, event});
    check(cudaEventRecord(event, stream_), "recording an event");
  }

  cudaStream_t stream_;
  std::vector<Mark> marks_;
};

class Passes {
 public:
  Passes(double scale, double seconds, const std::string& file)
      : scale_(scale), lines_(file, seconds) {
    if (scale < 1) repeats = 1, calls = 2;
  }

  void run() {
    part("device", [&] { return about(); });
    part("copy on the device", [&] { return copy_rate(); });
    part("pass, f32", [&] { return pass<float>(3, Layout::packed); });
    part("stages of a hull, points on the device", [&] { return stages(); });
    part("hull, points on the device", [&] { return hull_there(ball<float>(3, scaled(8e6))); });
    for (const double n : {1e5, 1e6})
      part("hull, a sphere's points on the device", [&] { return hull_there(sphere(scaled(n))); });
    part("pseudo-hull", [&] { return pseudo_hull(); });
    for (const unsigned d : {3U, 2U}) part("batch of sets of 50", [&] { return batch(d); });
    part("questions to a hull", [&] { return questions(); });
    part("questions to a hull, by cells", [&] { return questions_by_cells(); });
    part("moving points", [&] { return tracker(); });
    part("link, pinned memory", [&] { return link(); });
    for (const unsigned d : {2U, 4U, 5U, 6U})
      part("pass, f32", [&] { return pass<float>(d, Layout::packed); });
    part("pass, f64", [&] { return pass<double>(3, Layout::packed); });
    part("pass, f32, columns", [&] { return pass<float>(3, Layout::columns); });
    part("pass, f32, misaligned", [&] { return pass<float>(3, Layout::misaligned); });
    part("hull, points on the host", [&] { return hull_from_host(); });
    part("hulls on threads beside one another", [&] { return hulls_on_threads(); });
    part("pass, more than 2^31 points", [&] { return many_points(); });
    part("pass, more than 2^32 words of mask", [&] { return many_words(); });
  }
  bool failed() const { return lines_.failed(); }

 private:
  enum class Layout { packed, columns, misaligned };

  std::uint64_t scaled(double n) const {
    return std::max<std::uint64_t>(5000, static_cast<std::uint64_t>(n * scale_));
  }

  void part(const char* name, const std::function<ordered_json()>& work) {
    lines_.part({{"part", name}}, work);
  }

  ordered_json about() const {
    const CudaStatus status = cuda_status();
    return {{"name", status.device},           {"compute_capability", status.compute_capability},
            {"driver", status.driver_version}, {"runtime", status.runtime_version},
            {"memory", status.memory_bytes},   {"processors", this_device().multiprocessors}};
  }

  /// Bytes read plus bytes written, per second.
  ordered_json copy_rate() {
    const std::uint64_t bytes = scaled(1 << 30);
    const CudaStream stream;
    const DeviceArray<std::byte> from(bytes, stream.get()), to(bytes, stream.get());
    check(cudaMemsetAsync(from.data(), 1, bytes, stream.get()), "clearing");
    const double took = by_events(stream.get(), [&] {
      check(cudaMemcpyAsync(to.data(), from.data(), bytes, cudaMemcpyDeviceToDevice, stream.get()),
            "copying");
    });
    copy_rate_ = 2 * static_cast<double>(bytes) / took;
    return {{"bytes_per_second", copy_rate_}};
  }

  ordered_json link() const {
    const std::uint64_t bytes = scaled(1 << 28);
    const CudaStream stream;
    const DeviceArray<std::byte> there(bytes, stream.get());
    const PinnedArray<std::byte> here(bytes);
    std::fill_n(here.data(), bytes, std::byte{1});
    const double to = by_events(stream.get(), [&] {
      check(cudaMemcpyAsync(there.data(), here.data(), bytes, cudaMemcpyHostToDevice, stream.get()),
            "copying");
    });
    const double from = by_events(stream.get(), [&] {
      check(cudaMemcpyAsync(here.data(), there.data(), bytes, cudaMemcpyDeviceToHost, stream.get()),
            "copying");
    });
    const auto b = static_cast<double>(bytes);
    return {{"to_device_bytes_per_second", b / to}, {"from_device_bytes_per_second", b / from}};
  }

  /// `n` values on the device: the given values, repeated.
  template <class T>
  DeviceArray<T> repeated(const std::vector<T>& values, std::uint64_t n,
                          cudaStream_t stream) const {
    DeviceArray<T> all(n, stream);
    std::uint64_t have = std::min<std::uint64_t>(n, values.size());
    upload(all.data(), values.data(), have, stream);
    while (have < n) {
      const std::uint64_t more = std::min(have, n - have);
      check(cudaMemcpyAsync(all.data() + have, all.data(), more * sizeof(T),
                            cudaMemcpyDeviceToDevice, stream),
            "copying");
      have += more;
    }
    synchronise(stream, "copying");
    return all;
  }

  template <class T>
  static std::unique_ptr<internal::GaugeMap> map_of(const std::vector<T>& rows, unsigned d) {
    const Options options;
    const auto run = internal::Run(options).with_threads(1).with_budget(std::uint64_t{4} << 30);
    const auto view = PointView::row_major(rows.data(), rows.size() / d, d);
    internal::SampledPoints sample{view.count, d,
                                   [&](std::span<const std::uint64_t> ids) {
      return internal::gather_points(view, ids.data(), ids.size(), run);
                                   }};
    auto sampled = internal::map_of_sample(sample, internal::Insist::yes,
                                           most_gauge_nodes(this_device()), run);
    if (sampled.map == nullptr) throw std::runtime_error("no map: " + sampled.reason);
    return std::move(sampled.map);
  }

  /// The ids of the points that the map does not cull, in the host's memory.
  static std::vector<std::uint64_t> survivors(const internal::GaugeMap& map,
                                              const DevicePointView& view) {
    const DeviceIds there = survivors_of_device_points(map.table(), view);
    std::vector<std::uint64_t> ids(there.count);
    download(ids.data(), there.ids.data(), ids.size(), static_cast<cudaStream_t>(view.stream));
    return ids;
  }

  /// How many of `count` points a map keeps that are the points [0, period) again and again, from
  /// point `first` on; `ids`: those that it keeps of [0, period).
  static std::uint64_t kept_of_repeated(const std::vector<std::uint64_t>& ids, std::uint64_t period,
                                        std::uint64_t first, std::uint64_t count) {
    std::uint64_t kept = count / period * ids.size();
    for (const std::uint64_t id : ids) kept += (id + period - first) % period < count % period;
    return kept;
  }

  /// The kernel alone, by events; and including counting and listing, by the host's clock.
  /// `expected`: how many points it must keep.
  ordered_json time_pass(const internal::GaugeMap& map, const DevicePointView& view,
                         std::optional<std::uint64_t> expected) const {
    const auto stream = static_cast<cudaStream_t>(view.stream);
    const internal::GaugeTable& table = map.table();
    const DeviceArray<float> nodes(table.nodes.size(), stream);
    upload(nodes.data(), table.nodes.data(), table.nodes.size(), stream);
    const DeviceArray<std::uint32_t> mask(mask_room(view.count), stream);
    const double kernel = by_events(stream, [&] {
      check(gauge_mask(table, nodes.data(), view, mask.data(), this_device(), stream), "culling");
    });
    std::uint64_t kept = 0;
    const double listed = wall([&] { kept = survivors_of_device_points(table, view).count; });
    if (expected && kept != *expected)
      throw std::runtime_error("the pass keeps " + std::to_string(kept) + " points, not " +
                               std::to_string(*expected));
    const auto n = static_cast<double>(view.count);
    const double bytes = n * view.dimension * static_cast<double>(scalar_size(view.scalar));
    ordered_json json = {{"dimension", view.dimension},          {"count", view.count},
                         {"nodes", table.nodes.size()},          {"kernel_seconds", kernel},
                         {"points_per_second", n / kernel},      {"with_list_seconds", listed},
                         {"kept", static_cast<double>(kept) / n}};
    if (expected) json["as_many_as_its_part"] = true;
    if (copy_rate_ > 0) json["share_of_copy"] = bytes / kernel / copy_rate_;
    return json;
  }

  template <class T>
  ordered_json pass(unsigned d, Layout layout) const {
    const std::vector<T> rows = ball<T>(d, scaled(1e6));
    const auto map = map_of(rows, d);
    const std::uint64_t n = scaled(layout == Layout::packed && d == 3 ? 1e8 : 3e7);
    const CudaStream stream;
    const bool shifted = layout == Layout::misaligned;
    const DeviceArray<T> there = repeated(rows, n * d + (shifted ? d : 0), stream.get());
    // Read as columns, this memory holds other points in the same box; the pass takes as long.
    DevicePointView view =
        layout == Layout::columns
            ? DevicePointView::column_major(there.data(), n, d, stream.get())
            : DevicePointView::row_major(there.data() + (shifted ? d : 0), n, d, stream.get());
    std::optional<std::uint64_t> expected;
    if (layout != Layout::columns) {
      const std::uint64_t period = rows.size() / d;
      const auto ids =
          survivors(*map, DevicePointView::row_major(there.data(), period, d, stream.get()));
      expected = kept_of_repeated(ids, period, shifted ? 1 : 0, n);
    }
    return time_pass(*map, view, expected);
  }

  ordered_json many_points() const {
    const std::uint64_t n = scale_ < 1 ? scaled(1e6) + 777 : (std::uint64_t{1} << 31) + 1001;
    const std::vector<float> rows = ball<float>(3, scaled(1e6));
    const auto map = map_of(rows, 3);
    const CudaStream stream;
    const DeviceArray<float> there = repeated(rows, n * 3, stream.get());
    const std::uint64_t period = rows.size() / 3;
    const auto ids =
        survivors(*map, DevicePointView::row_major(there.data(), period, 3, stream.get()));
    return time_pass(*map, DevicePointView::row_major(there.data(), n, 3, stream.get()),
                     kept_of_repeated(ids, period, 0, n));
  }

  /// One point, read so often that the mask has more than 2^32 words (17 GB): an inner one into a
  /// mask of ones, an outer one into a mask of zeros. Word and tile numbers are counted.
  ordered_json many_words() const {
    const std::uint64_t words = scale_ < 1 ? 3000 : (std::uint64_t{1} << 32) + 3000;
    const std::uint64_t n = words * 32 - 5;
    const auto map = map_of(ball<float>(3, scaled(1e6)), 3);
    const internal::GaugeTable& table = map->table();
    const CudaStream stream;
    const DeviceArray<float> nodes(table.nodes.size(), stream.get());
    upload(nodes.data(), table.nodes.data(), table.nodes.size(), stream.get());
    const DeviceArray<std::uint32_t> mask(mask_room(n), stream.get());
    ordered_json json = {{"words", words}, {"count", n}};
    for (const bool inner : {true, false}) {
      const std::vector<float> point =
          inner ? std::vector<float>{0.1F, 0.05F, 0.02F} : std::vector<float>{2, 1, 0.5F};
      const DeviceArray<float> there(3, stream.get());
      upload(there.data(), point.data(), point.size(), stream.get());
      DevicePointView view = DevicePointView::row_major(there.data(), n, 3, stream.get());
      view.point_stride = 0;
      check(cudaMemsetAsync(mask.data(), inner ? 0xFF : 0, words * sizeof(std::uint32_t),
                            stream.get()),
            "clearing");
      const double took = between_events(stream.get(), [&] {
        check(gauge_mask(table, nodes.data(), view, mask.data(), this_device(), stream.get()),
              "culling");
      });
      const std::uint64_t kept = bits_of(mask.data(), words, stream.get());
      if (kept != (inner ? 0 : n))
        throw std::runtime_error("the mask has " + std::to_string(kept) + " points");
      json[inner ? "inner_seconds" : "outer_seconds"] = took;
    }
    return json;
  }

  /// Offsets of a mask's tiles in the list of its bits; the last one is how many there are.
  struct Offsets {
    DeviceArray<std::uint64_t> there;
    std::uint64_t total = 0;
  };

  static Offsets offsets_of(const std::uint32_t* mask, std::uint64_t words, cudaStream_t stream) {
    const std::uint64_t tiles = (words + tile_words - 1) / tile_words;
    const DeviceArray<std::uint64_t> counts(tiles + 1, stream);
    Offsets offsets;
    offsets.there = DeviceArray<std::uint64_t>(tiles + 1, stream);
    check(cudaMemsetAsync(counts.data() + tiles, 0, sizeof(std::uint64_t), stream), "counting");
    check(count_bits(mask, words, counts.data(), stream), "counting");
    std::size_t bytes = 0;
    check(sum_counts(nullptr, bytes, counts.data(), offsets.there.data(), tiles + 1, stream),
          "counting");
    const DeviceArray<std::byte> scratch(std::max<std::size_t>(bytes, 1), stream);
    check(sum_counts(scratch.data(), bytes, counts.data(), offsets.there.data(), tiles + 1, stream),
          "counting");
    download(&offsets.total, offsets.there.data() + tiles, 1, stream);
    return offsets;
  }

  static std::uint64_t bits_of(const std::uint32_t* mask, std::uint64_t words,
                               cudaStream_t stream) {
    return offsets_of(mask, words, stream).total;
  }

  /// The stages of convex_hull for points of a ball on the device, one after another as
  /// src/cuda/device_filter.cpp runs them; the hull and the survivors must be that call's.
  ordered_json stages() const {
    const std::uint64_t n = scaled(8e6);
    const std::vector<float> rows = ball<float>(3, n);
    const CudaStream stream;
    const DeviceArray<float> there = repeated(rows, n * 3, stream.get());
    const auto view = DevicePointView::row_major(there.data(), n, 3, stream.get());
    Hull hull, call;
    Stages stages(stream.get());
    std::uint64_t passed = 0, kept = 0;
    for (unsigned k = 0; k <= repeats; ++k) hull = by_stages(view, stages, passed, kept);
    const double seconds = wall([&] { call = convex_hull(view, on(Backend::cuda)); });
    require_same(hull, call);
    if (call.statistics.filter == UsedFilter::gauge_pseudo_hull &&
        call.statistics.survivors != kept)
      throw std::runtime_error("the stages are not those of the call");
    return {{"count", n},
            {"left_by_the_pass", passed},
            {"survivors", kept},
            {"stage_seconds", stages.medians()},
            {"call_seconds", seconds}};
  }

  static Hull by_stages(const DevicePointView& view, Stages& stages, std::uint64_t& passed,
                        std::uint64_t& kept) {
    const auto stream = static_cast<cudaStream_t>(view.stream);
    const std::uint64_t n = view.count;
    const Options options = on(Backend::cuda);
    const internal::Run run(options);
    const auto one_thread =
        internal::Run(options).with_threads(1).with_budget(std::uint64_t{4} << 30);
    stages.begin();
    internal::InnerPolytope polytope;
    std::uint64_t size = internal::probe_sample_size(n, 3);
    for (const bool last : {false, true}) {  // a small sample, then that of the map
      const Array<std::uint64_t> ids = internal::sample_ids(n, size);
      Array<double> sample = download_points(view, ids.data(), ids.size(), run);
      stages.end("sample");
      polytope = internal::inner_polytope(std::move(sample), 3, one_thread);
      stages.end("hull of sample");
      if (last) break;
      size =
          std::min(internal::map_sample_size(n, 3, ids.size(), polytope.vertices.size() / 3, false),
                   ids.size());
    }
    const auto map = internal::map_of_polytope(std::move(polytope), n, internal::Insist::no,
                                               most_gauge_nodes(this_device()), run);
    if (map == nullptr) throw std::runtime_error("no map");
    const internal::GaugeTable& table = map->table();
    stages.end("map");
    const DeviceArray<float> nodes(table.nodes.size(), stream);
    upload(nodes.data(), table.nodes.data(), table.nodes.size(), stream);
    const std::uint64_t words = mask_words(n);
    const DeviceArray<std::uint32_t> mask(mask_room(n), stream);
    check(gauge_mask(table, nodes.data(), view, mask.data(), this_device(), stream), "culling");
    stages.end("pass");
    const Offsets offsets = offsets_of(mask.data(), words, stream);
    passed = offsets.total;
    const DeviceArray<std::uint64_t> left(passed, stream);
    if (passed > 0)
      check(list_bits(mask.data(), words, offsets.there.data(), left.data(), stream), "listing");
    const DeviceArray<float> left_rows(passed * 3, stream);
    check(gather_rows(view, left.data(), passed, left_rows.data(), stream), "gathering points");
    const auto left_view = DevicePointView::row_major(left_rows.data(), passed, 3, view.stream);
    stages.end("list");
    StarHullThere found = star_hull_there(left_view, run, {});
    const DeviceIds& inner = found.ids;
    kept = inner.count;
    stages.end("pseudo-hull, convex");
    const DeviceArray<std::uint64_t> ids(kept, stream);
    check(gather_ids(left.data(), inner.ids.data(), kept, ids.data(), stream), "gathering ids");
    const DeviceArray<float> kept_rows(kept * 3, stream);
    check(gather_rows(left_view, inner.ids.data(), kept, kept_rows.data(), stream),
          "gathering points");
    internal::Filtered filtered;
    filtered.survivors.ids.resize(kept);
    download(filtered.survivors.ids.data(), ids.data(), kept, stream);
    filtered.rows = download_points(
        DevicePointView::row_major(kept_rows.data(), kept, 3, view.stream), nullptr, kept, run);
    filtered.triangles = std::move(found.triangles);
    stages.end("download");
    Hull hull = internal::hull_of_rows(std::move(filtered), view, options);
    stages.end("hull");
    return hull;
  }

  static Options on(Backend backend) {
    Options options;
    options.backend = backend;
    return options;
  }

  static void require_same(const Hull& a, const Hull& b) {
    if (a.vertices != b.vertices || a.volume != b.volume)
      throw std::runtime_error("the device's hull is not the CPU's");
  }

  /// The hull of points on the device, compared with the CPU's from host memory.
  static std::vector<float> sphere(std::uint64_t n) {
    const std::vector<double> rows = generate("sphere", n, 3, 1);
    return {rows.begin(), rows.end()};
  }

  ordered_json hull_there(const std::vector<float>& rows) const {
    const std::uint64_t n = rows.size() / 3;
    const CudaStream stream;
    const DeviceArray<float> there = repeated(rows, n * 3, stream.get());
    const auto view = DevicePointView::row_major(there.data(), n, 3, stream.get());
    const auto here = PointView::row_major(rows.data(), n, 3);
    Hull device, host;
    const double d = wall([&] { device = convex_hull(view, on(Backend::cuda)); });
    DeviceHull left;
    const double l = wall([&] { left = convex_hull_on_device(view, on(Backend::cuda)); });
    const double h = wall([&] { host = convex_hull(here, on(Backend::cpu)); });
    require_same(device, host);
    if (left.volume != host.volume) throw std::runtime_error("a hull left there is another one");
    const Options options = on(Backend::cuda);
    const StarHullThere found =
        star_hull_there(view, internal::Run(options), {.place = internal::HullPlace::nowhere});
    return {{"count", n},
            {"star_growth_seconds", found.counts.growth_seconds},
            {"star_flip_seconds", found.counts.flip_seconds},
            {"star_vertices", found.counts.vertices},
            {"star_flip_rounds", found.counts.flip_rounds},
            {"star_aside", found.counts.aside},
            {"device_seconds", d},
            {"of_that_cull", device.statistics.cull_seconds},
            {"left_there_seconds", l},
            {"survivors", device.statistics.survivors},
            {"filter", filter_name(device.statistics.filter)},
            {"reason", device.statistics.cull_reason},
            {"cpu_seconds", h},
            {"cpu_survivors", host.statistics.survivors},
            {"threads", host.statistics.threads}};
  }

  ordered_json hull_from_host() const {
    const std::uint64_t n = scaled(2e7);
    const std::vector<float> rows = ball<float>(3, n);
    const auto here = PointView::row_major(rows.data(), n, 3);
    const auto map = map_of(rows, 3);
    const Options options;
    const internal::Run run(options);
    const double pass = wall([&] { (void)survivors_of_host_points(map->table(), here, run); });
    Hull device, host;
    const double d = wall([&] { device = convex_hull(here, on(Backend::cuda)); });
    const double h = wall([&] { host = convex_hull(here, on(Backend::cpu)); });
    require_same(device, host);
    return {{"count", n},
            {"pass_seconds", pass},
            {"pass_bytes_per_second", 12 * static_cast<double>(n) / pass},
            {"device_seconds", d},
            {"cpu_seconds", h}};
  }

  ordered_json hulls_on_threads() const {
    constexpr unsigned count = 4;
    const std::uint64_t n = scaled(2e6);
    const std::vector<float> rows = ball<float>(3, n);
    std::vector<CudaStream> streams(count);
    std::vector<DeviceArray<float>> there;
    for (const CudaStream& s : streams) there.push_back(repeated(rows, n * 3, s.get()));
    const auto hull = [&](unsigned t) {
      Options options = on(Backend::cuda);
      options.threads = 1;
      (void)convex_hull(DevicePointView::row_major(there[t].data(), n, 3, streams[t].get()),
                        options);
    };
    const double alone = wall([&] {
      for (unsigned t = 0; t < count; ++t) hull(t);
    });
    const double together = wall([&] {
      std::vector<std::thread> threads;
      for (unsigned t = 0; t < count; ++t) threads.emplace_back(hull, t);
      for (std::thread& t : threads) t.join();
    });
    return {{"threads", count},
            {"count", n},
            {"one_after_another_seconds", alone},
            {"together_seconds", together}};
  }

  ordered_json pseudo_hull() const {
    const std::uint64_t n = scaled(8e6);
    const std::vector<float> rows = ball<float>(3, n);
    const CudaStream stream;
    const DeviceArray<float> there = repeated(rows, n * 3, stream.get());
    const auto view = DevicePointView::row_major(there.data(), n, 3, stream.get());
    const Options options;
    const internal::Control control(options);
    std::vector<internal::PseudoHullRound> rounds;
    std::uint64_t kept = 0;
    const double took = wall(
        [&] { kept = internal::pseudo_hull_survivors_cuda(view, {}, control, &rounds).size(); });
    ordered_json json = {{"count", n}, {"seconds", took}, {"kept", kept}};
    for (const auto& r : rounds) json["rounds"].push_back({r.facets, r.exterior, r.culled, r.kept});
    return json;
  }

  /// A rotating ball, in device and in host memory.
  ordered_json tracker() const {
    const std::uint64_t n = scaled(1e6);
    constexpr unsigned frames = 12;
    std::vector<float> rows = ball<float>(3, n);
    const CudaStream stream;
    const DeviceArray<float> there(n * 3, stream.get());
    HullTracker device(on(Backend::cuda)), host(on(Backend::cpu));
    std::vector<double> on_device, on_host;
    for (unsigned f = 0; f < frames; ++f) {
      for (std::uint64_t i = 0; i < n; ++i) {
        float* p = rows.data() + 3 * i;
        const float x = p[0], y = p[1];
        p[0] = x - 0.01F * y;
        p[1] = y + 0.01F * x;
      }
      upload(there.data(), rows.data(), rows.size(), stream.get());
      auto start = Clock::now();
      (void)device.update(DevicePointView::row_major(there.data(), n, 3, stream.get()));
      on_device.push_back(seconds_since(start));
      start = Clock::now();
      (void)host.update(PointView::row_major(rows.data(), n, 3));
      on_host.push_back(seconds_since(start));
      require_same(device.hull(), host.hull());
    }
    return {{"count", n},
            {"frames", frames},
            {"device_seconds", median({on_device.begin() + 2, on_device.end()})},
            {"cpu_seconds", median({on_host.begin() + 2, on_host.end()})}};
  }

  /// 100,000 sets of 50 points of a ball: the kernels by events, both kinds of results, and the
  /// CPU.
  ordered_json batch(unsigned d) const {
    constexpr std::uint64_t size = 50;
    const auto sets = std::max<std::uint64_t>(200, static_cast<std::uint64_t>(1e5 * scale_));
    const std::vector<float> rows = ball<float>(d, sets * size);
    std::vector<std::uint64_t> offsets(sets + 1);
    for (std::uint64_t i = 0; i <= sets; ++i) offsets[i] = i * size;
    const CudaStream stream;
    const DeviceArray<float> points(rows.size(), stream.get());
    upload(points.data(), rows.data(), rows.size(), stream.get());
    const auto there = DevicePointView::row_major(points.data(), sets * size, d, stream.get());
    const auto here = PointView::row_major(rows.data(), sets * size, d);

    const DeviceArray<std::uint64_t> starts(offsets.size(), stream.get());
    upload(starts.data(), offsets.data(), offsets.size(), stream.get());
    const DeviceArray<std::uint16_t> counts(sets, stream.get());
    const DeviceArray<std::uint8_t> vertices(sets * size, stream.get()),
        simplices(sets * size * simplex_room(d), stream.get());
    const WarpSets task{starts.data(), static_cast<std::uint32_t>(sets), counts.data(),
                        vertices.data(), simplices.data()};
    const double kernel = by_events(stream.get(), [&] {
      check(find_set_hulls(there, task, 33, 64, stream.get()), "hulling sets");
    });
    const DeviceArray<double> numbers(sets * (d + 2), stream.get());
    const DeviceArray<std::int8_t> exponents(sets, stream.get());
    const SetMeasures measures{numbers.data(), numbers.data() + sets, numbers.data() + 2 * sets,
                               exponents.data()};
    const double measuring = by_events(stream.get(), [&] {
      check(measure_sets(there, task, measures, stream.get()), "measuring hulls");
    });
    HullBatch device, host;
    const double to_host =
        wall([&] { device = convex_hulls(there, offsets.data(), sets, on(Backend::cuda)); });
    DeviceHullBatch left;
    const double on_device = wall(
        [&] { left = convex_hulls_on_device(there, offsets.data(), sets, on(Backend::cuda)); });
    DeviceHullBatch measured;
    const double with_measures = wall([&] {
      measured = convex_hulls_on_device(there, offsets.data(), sets, on(Backend::cuda),
                                        {.planes = true, .measures = true});
    });
    std::vector<double> volumes(sets);
    download(volumes.data(), measured.volumes, sets, stream.get());
    const double cpu = wall([&] { host = convex_hulls(here, offsets); });
    if (device.vertices != host.vertices || device.volumes != host.volumes ||
        left.vertex_count != host.vertices.items.size() || volumes != host.volumes)
      throw std::runtime_error("the device's batch is not the CPU's");
    return {{"dimension", d},
            {"sets", sets},
            {"kernel_seconds", kernel},
            {"to_host_seconds", to_host},
            {"left_there_seconds", on_device},
            {"measures_kernel_seconds", measuring},
            {"left_there_with_planes_and_measures_seconds", with_measures},
            {"cpu_seconds", cpu}};
  }

  /// Queries for points in and around a ball to the hull of some of its points.
  ordered_json questions() const {
    const std::uint64_t n = scaled(1e6);
    std::vector<float> rows = ball<float>(3, n);
    const auto some = PointView::row_major(rows.data(), std::min<std::uint64_t>(n, 100000), 3);
    const HullQuery query(some, convex_hull(some));
    for (float& v : rows) v *= 1.1F;
    const CudaStream stream;
    const DeviceArray<float> points(rows.size(), stream.get());
    upload(points.data(), rows.data(), rows.size(), stream.get());
    const auto there = DevicePointView::row_major(points.data(), n, 3, stream.get());
    const auto here = PointView::row_major(rows.data(), n, 3);
    std::vector<std::uint8_t> device(n), host(n);
    std::vector<std::uint64_t> device_vertices(n), host_vertices(n);
    const double contains = wall([&] { query.contains(there, device.data(), on(Backend::cuda)); });
    const double cpu_contains = wall([&] { query.contains(here, host.data()); });
    const DeviceMemory memory = device_memory(there, n);
    auto* const answers = static_cast<std::uint8_t*>(memory.data.get());
    const double left_there =
        wall([&] { query.contains_on_device(there, answers, on(Backend::cuda)); });
    std::vector<std::uint8_t> left(n);
    download(left.data(), answers, n, stream.get());
    const double supports =
        wall([&] { query.supports(there, device_vertices.data(), on(Backend::cuda)); });
    const double cpu_supports = wall([&] { query.supports(here, host_vertices.data()); });
    if (device != host || left != host || device_vertices != host_vertices)
      throw std::runtime_error("the device's answers are not the CPU's");
    return {{"count", n},
            {"contains_seconds", contains},
            {"contains_left_there_seconds", left_there},
            {"cpu_contains_seconds", cpu_contains},
            {"supports_seconds", supports},
            {"cpu_supports_seconds", cpu_supports}};
  }

  /// The kernel that finds sides by cells of directions, alone: points in and around a ball, a hull
  /// of 10,000 facets.
  ordered_json questions_by_cells() const {
    const std::uint64_t n = scaled(1e7);
    std::vector<float> rows = ball<float>(3, n);
    for (float& v : rows) v *= 1.1F;
    const std::vector<double> sphere = generate("sphere", std::min<std::uint64_t>(n, 5000), 3);
    const auto corners = PointView::row_major(sphere.data(), sphere.size() / 3, 3);
    const Options options;
    const internal::Run run(options);
    const Hull hull = convex_hull(corners);
    const internal::QueryPoints vertices = internal::make_query_points(&corners, hull, run.control);
    const internal::FacetSearch search(vertices, hull, run.control);
    std::unique_ptr<internal::FacetCells> cells;
    const double build = wall([&] { cells = internal::FacetCells::build(search, vertices, run); });
    const CudaStream stream;
    const DeviceArray<float> points = repeated(rows, rows.size(), stream.get());
    const auto there = DevicePointView::row_major(points.data(), n, 3, stream.get());
    KeptTables kept;
    const CellsThere cells_there = kept_there(kept, cells->table(), stream.get());
    const DeviceArray<std::uint8_t> sides(n, stream.get());
    const DeviceArray<std::uint32_t> open(1 + n, stream.get());
    std::uint32_t left = 0;
    const double kernel = by_events(stream.get(), [&] {
      check(cudaMemsetAsync(open.data(), 0, sizeof left, stream.get()), "clearing");
      check(ask_sides_by_cells(there, cells_there, {1, 0}, sides.data(),
                               {open.data(), open.data() + 1}, stream.get()),
            "asking a hull");
    });
    download(&left, open.data(), 1, stream.get());
    std::vector<std::uint8_t> device(n), host(n);
    download(device.data(), sides.data(), n, stream.get());
    HullQuery(corners, hull).contains(PointView::row_major(rows.data(), n, 3), host.data());
    std::uint64_t different = 0;
    for (std::uint64_t i = 0; i < n; ++i) different += device[i] != host[i];
    if (different > left) throw std::runtime_error("the device's answers are not the CPU's");
    return {{"count", n},
            {"facets", hull.facet_count()},
            {"cells", cells->table().starts.size() - 1},
            {"build_seconds", build},
            {"kernel_seconds", kernel},
            {"points_per_second", static_cast<double>(n) / kernel},
            {"open", left}};
  }

  double scale_, copy_rate_ = 0;
  bench::JsonLines lines_;
};

[[noreturn]] void bad_usage(const std::string& what) {
  std::fprintf(stderr, "gpu_passes: %s\nusage: gpu_passes [--out FILE] [--scale S] [--seconds T]\n",
               what.c_str());
  std::exit(2);
}

}  // namespace

int main(int argc, char** argv) {
  std::string file;
  double scale = 1, seconds = 300;
  for (int i = 1; i < argc; ++i) {
    const std::string a = argv[i];
    if (i + 1 >= argc) bad_usage(a + " is unknown or wants a value");
    const char* value = argv[++i];
    if (a == "--out")
      file = value;
    else if (a == "--scale")
      scale = std::atof(value);
    else if (a == "--seconds")
      seconds = std::atof(value);
    else
      bad_usage("unknown option " + a);
  }
  if (!(scale > 0 && scale <= 1)) bad_usage("--scale must be in (0, 1]");
  try {
    const CudaStatus status = cuda_status();
    if (!status.available) {
      std::fprintf(stderr, "gpu_passes: %s\n", status.reason.c_str());
      return 5;
    }
    Passes passes(scale, seconds, file);
    passes.run();
    return passes.failed() ? 1 : 0;
  } catch (const std::exception& e) {
    std::fprintf(stderr, "gpu_passes: %s\n", e.what());
    return 1;
  }
}
