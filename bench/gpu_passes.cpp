// Times of a device's calls and of their steps: gpu_passes [--out FILE] [--scale S] [--seconds T]
// [--part PART]
//
// Prints one JSON object per line as soon as it is measured, and appends it to FILE, so that an
// interrupted run reports what it has done. A kernel's time is a tenth of that of ten calls between
// two events of their stream; everything else is timed by the host's clock. First, least, median
// and most of a first run and five others. Beside a call stand what was predicted for it and what
// it should take, and the median's ratio to each. Parts that do not fit into the device's memory,
// or would start after T seconds, are skipped and reported as skipped; with --part all but those
// whose name begins so are. Exit status 5: no device.
#include <cuda_runtime_api.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <thread>
#include <utility>
#include <vector>

#include "cuda/gauge.hpp"
#include "cuda/hull_questions.hpp"
#include "cuda/kept_tables.hpp"
#include "cuda/kernels/gauge_kernel.hpp"
#include "cuda/kernels/hull_questions_kernel.hpp"
#include "cuda/kernels/set_hulls_kernel.hpp"
#include "cuda/kernels/star_hull.hpp"
#include "cuda/runtime.hpp"
#include "cullhull/cullhull.hpp"
#include "cullhull/device_hull.hpp"
#include "cullhull/device_points.hpp"
#include "cullhull/generate.hpp"
#include "filter/gauge/gauge_map.hpp"
#include "filter/planner.hpp"
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

/// Of calls after a first one, which also loads and allocates.
struct Times {
  double first = 0, least = 0, median = 0, most = 0;
};

Times times_of(double first, std::vector<double> others) {
  if (others.empty()) others.push_back(first);
  std::sort(others.begin(), others.end());
  return {first, others.front(), others[others.size() / 2], others.back()};
}

ordered_json told(const Times& times) {
  return {{"first", times.first},
          {"least", times.least},
          {"median", times.median},
          {"most", times.most}};
}

/// Timed runs, and calls between two events; a run of smaller sets, which is a test, makes fewer.
unsigned repeats = 5, calls = 10;

double seconds_of(const std::function<void()>& work) {
  const auto start = Clock::now();
  work();
  return seconds_since(start);
}

Times timed(const std::function<void()>& work, unsigned others = repeats) {
  const double first = seconds_of(work);
  std::vector<double> times;
  for (unsigned k = 0; k < others; ++k) times.push_back(seconds_of(work));
  return times_of(first, std::move(times));
}

double wall(const std::function<void()>& work) { return timed(work).median; }

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
  return times_of(0, std::move(times)).median;
}

std::vector<float> points_of(const char* shape, std::uint64_t n, unsigned d) {
  const std::vector<double> rows = generate(shape, n, d);
  return {rows.begin(), rows.end()};
}

enum class Kind { hull, host, frames, sets };

/// Milliseconds: predicted for an H200 from counts and rates of earlier runs (bench/notes/gpu.md,
/// "The next run: predictions"), and wanted; 0: neither.
struct Goal {
  double predicted, wanted;
};

/// What is measured whole: points of a shape, f32; of frames the motion, too.
struct Row {
  Kind kind;
  const char* shape;
  unsigned d;
  double count;
  Goal to_host, left_there;
  const char* motion = "";
};

/// `count` is divided by 50 for sets of that size.
constexpr Row rows_of_run[] = {
    {Kind::hull, "ball", 3, 8e6, {1.9, 1.5}, {1.8, 0}},
    {Kind::hull, "ball", 3, 1e8, {7, 3.5}, {}},
    {Kind::hull, "sphere", 3, 1e6, {15, 12}, {10, 7}},
    {Kind::hull, "sphere", 3, 1e5, {2.9, 0}, {2.4, 0}},
    {Kind::hull, "shell", 3, 1e6, {1.6, 0}, {}},
    {Kind::hull, "cube", 3, 2e6, {2.3, 0}, {}},
    {Kind::hull, "gauss", 3, 2e6, {1.5, 0}, {}},
    {Kind::hull, "scan", 3, 1e6, {3.1, 0}, {}},
    {Kind::hull, "bumpy", 3, 3.6e6, {4.2, 0}, {}},
    {Kind::hull, "ball", 3, 65536, {1.1, 0.8}, {}},
    {Kind::hull, "ball", 3, 131072, {1.1, 0}, {}},
    {Kind::hull, "ball", 4, 8e6, {373, 190}, {}},
    {Kind::frames, "ball", 3, 1e6, {0.8, 0.6}, {}, "spin"},
    {Kind::frames, "bumpy", 3, 1e6, {0.8, 0.6}, {}, "twist"},
    {Kind::frames, "bumpy", 3, 1e6, {0.8, 0.6}, {}, "fracture"},
    {Kind::host, "ball", 3, 2e7, {18, 20}, {}},
    {Kind::sets, "ball", 3, 5e6, {47.5, 16}, {3, 2.8}},
    {Kind::sets, "ball", 2, 5e6, {}, {1.3, 0}},
    {Kind::hull, "sphere", 3, 2e7, {}, {170, 0}},
};

ordered_json told(const Times& times, Goal goal) {
  ordered_json json = told(times);
  const auto beside = [&](const char* name, const char* ratio, double milliseconds) {
    if (milliseconds == 0) return;
    json[name] = 1e-3 * milliseconds;
    json[ratio] = times.median / (1e-3 * milliseconds);
  };
  beside("predicted", "of_predicted", goal.predicted);
  beside("wanted", "of_wanted", goal.wanted);
  return json;
}

class Passes {
 public:
  Passes(double scale, double seconds, const std::string& file, std::string only)
      : scale_(scale), only_(std::move(only)), lines_(file, seconds) {
    if (scale < 1) repeats = 1, calls = 2;
  }

  void run() {
    part("device", [&] { return about(); });
    part("first call", [&] { return first_call(); });
    for (const Row& row : rows_of_run) {
      switch (row.kind) {
        case Kind::hull:
          part("hull, points on the device", [&] { return hull(row); });
          break;
        case Kind::host:
          part("hull, points on the host", [&] { return hull_from_host(row); });
          break;
        case Kind::frames:
          part("moving points", [&] { return frames(row); });
          break;
        case Kind::sets:
          part("batch of sets of 50", [&] { return batch(row); });
      }
    }
    part("questions to a hull", [&] { return questions(); });
    part("questions to a hull, by cells", [&] { return questions_by_cells(); });
    part("copy on the device", [&] { return copy_rate(); });
    part("link, pinned memory", [&] { return link(); });
    for (const unsigned d : {3U, 4U}) part("pass, f32", [&] { return pass(d); });
    part("hulls on threads beside one another", [&] { return hulls_on_threads(); });
    part("pass, more than 2^31 points", [&] { return many_points(); });
  }
  bool failed() const { return lines_.failed(); }

 private:
  std::uint64_t scaled(double n) const {
    return std::min(static_cast<std::uint64_t>(n),
                    std::max<std::uint64_t>(2500, static_cast<std::uint64_t>(n * scale_)));
  }

  void part(const char* name, const std::function<ordered_json()>& work) {
    if (std::string_view(name).starts_with(only_)) lines_.part({{"part", name}}, work);
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
    const auto here = pinned<std::byte>(bytes);
    std::fill_n(here.get(), bytes, std::byte{1});
    const double to = by_events(stream.get(), [&] {
      check(cudaMemcpyAsync(there.data(), here.get(), bytes, cudaMemcpyHostToDevice, stream.get()),
            "copying");
    });
    const double from = by_events(stream.get(), [&] {
      check(cudaMemcpyAsync(here.get(), there.data(), bytes, cudaMemcpyDeviceToHost, stream.get()),
            "copying");
    });
    const auto b = static_cast<double>(bytes);
    return {{"to_device_bytes_per_second", b / to}, {"from_device_bytes_per_second", b / from}};
  }

  /// `n` values on the device: the given values, repeated.
  static DeviceArray<float> repeated(const std::vector<float>& values, std::uint64_t n,
                                     cudaStream_t stream) {
    DeviceArray<float> all(n, stream);
    std::uint64_t have = std::min<std::uint64_t>(n, values.size());
    upload(all.data(), values.data(), have, stream);
    while (have < n) {
      const std::uint64_t more = std::min(have, n - have);
      check(cudaMemcpyAsync(all.data() + have, all.data(), more * sizeof(float),
                            cudaMemcpyDeviceToDevice, stream),
            "copying");
      have += more;
    }
    synchronise(stream, "copying");
    return all;
  }

  static std::unique_ptr<internal::GaugeMap> map_of(const std::vector<float>& rows, unsigned d) {
    const Options options;
    const auto run = internal::Run(options).with_threads(1).with_budget(std::uint64_t{4} << 30);
    const auto view = PointView::row_major(rows.data(), rows.size() / d, d);
    internal::SampledPoints sample{view.count, d,
                                   [&](std::span<const std::uint64_t> ids) {
      return internal::gather_points(view, ids.data(), ids.size(), run);
                                   }};
    auto sampled = internal::map_of_sample(sample, internal::Insist::yes, most_map_nodes(), run);
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

  ordered_json pass(unsigned d) const {
    const std::vector<float> rows = points_of("ball", scaled(1e6), d);
    const auto map = map_of(rows, d);
    const std::uint64_t n = scaled(d == 3 ? 1e8 : 3e7);
    const CudaStream stream;
    const DeviceArray<float> there = repeated(rows, n * d, stream.get());
    const std::uint64_t period = rows.size() / d;
    const auto ids =
        survivors(*map, DevicePointView::row_major(there.data(), period, d, stream.get()));
    return time_pass(*map, DevicePointView::row_major(there.data(), n, d, stream.get()),
                     kept_of_repeated(ids, period, 0, n));
  }

  ordered_json many_points() const {
    const std::uint64_t n = scale_ < 1 ? scaled(1e6) + 777 : (std::uint64_t{1} << 31) + 1001;
    const std::vector<float> rows = points_of("ball", scaled(1e6), 3);
    const auto map = map_of(rows, 3);
    const CudaStream stream;
    const DeviceArray<float> there = repeated(rows, n * 3, stream.get());
    const std::uint64_t period = rows.size() / 3;
    const auto ids =
        survivors(*map, DevicePointView::row_major(there.data(), period, 3, stream.get()));
    return time_pass(*map, DevicePointView::row_major(there.data(), n, 3, stream.get()),
                     kept_of_repeated(ids, period, 0, n));
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

  /// Half of space is empty of them, as of an airborne scan: heights over a square, in steps of a
  /// centimetre.
  static std::vector<float> scan(std::uint64_t n) {
    std::vector<float> rows;
    const std::vector<double> places = generate("cube", n, 3);
    for (std::uint64_t i = 0; i < n; ++i) {
      const double x = 500 * places[3 * i], y = 500 * places[3 * i + 1];
      const double z = 20 * std::sin(0.01 * x) * std::cos(0.013 * y) + 5 * places[3 * i + 2];
      for (const double v : {x, y, z}) rows.push_back(static_cast<float>(std::round(100 * v)));
    }
    return rows;
  }

  std::vector<float> points_of_row(const Row& row) const {
    const std::uint64_t n = scaled(row.count);
    if (row.shape == std::string_view("scan")) return scan(n);
    return points_of(row.shape, n, row.d);
  }

  static ordered_json head_of(const Row& row, std::uint64_t n) {
    return {{"set", row.shape}, {"dimension", row.d}, {"count", n}};
  }

  /// What a process pays once: its context, then the kernels that a call loads.
  ordered_json first_call() const {
    const double context = seconds_of([] { check(cudaFree(nullptr), "making a context"); });
    const std::vector<float> rows = points_of_row(rows_of_run[0]);
    const CudaStream stream;
    const DeviceArray<float> there = repeated(rows, rows.size(), stream.get());
    const auto view = DevicePointView::row_major(there.data(), rows.size() / 3, 3, stream.get());
    const Times times = timed([&] { (void)convex_hull(view, on(Backend::cuda)); });
    return {{"context_seconds", context}, {"seconds", told(times)}};
  }

  static ordered_json counts_of(const StarCounts& counts,
                                const std::vector<internal::PseudoHullRound>& rounds,
                                std::uint64_t n) {
    std::uint64_t exterior = 0;
    for (const auto& round : rounds) exterior += round.exterior;
    return {{"leaders", counts.leaders},
            {"from_last_frame", counts.moved},
            {"growth_rounds", rounds.size()},
            {"exterior_by_n", static_cast<double>(exterior) / static_cast<double>(n)},
            {"vertices_grown", counts.vertices},
            {"flip_rounds", counts.flip_rounds},
            {"aside", counts.aside},
            {"whole", counts.whole()}};
  }

  /// Steps of the surface of all points, which is the whole of a call where doubles decide it.
  static ordered_json surface_stages(const DevicePointView& view) {
    const Options options = on(Backend::cuda);
    const internal::Run run(options);
    std::vector<double> growth, flips, result;
    ordered_json counts;
    for (unsigned k = 0; k <= repeats; ++k) {
      std::vector<internal::PseudoHullRound> rounds;
      StarHullThere found;
      const double all =
          seconds_of([&] { found = star_hull_there(view, run, {.rounds = &rounds}); });
      counts = counts_of(found.counts, rounds, view.count);
      growth.push_back(found.counts.growth_seconds);
      flips.push_back(found.counts.flip_seconds);
      result.push_back(all - growth.back() - flips.back());
    }
    const auto stage = [](const std::vector<double>& of) {
      return told(times_of(of.front(), {of.begin() + 1, of.end()}));
    };
    counts["stage_seconds"] = {{"leaders and growth", stage(growth)},
                               {"flips", stage(flips)},
                               {"list, result and its copy", stage(result)}};
    return counts;
  }

  /// The hull of points on the device, compared with the CPU's from the host's memory.
  ordered_json hull(const Row& row) const {
    const std::vector<float> rows = points_of_row(row);
    const std::uint64_t n = rows.size() / row.d;
    const CudaStream stream;
    const DeviceArray<float> there = repeated(rows, rows.size(), stream.get());
    const auto view = DevicePointView::row_major(there.data(), n, row.d, stream.get());
    const auto here = PointView::row_major(rows.data(), n, row.d);
    ordered_json json = head_of(row, n);
    // Of the largest result the CPU's first is enough to compare with.
    const bool only_there = row.left_there.predicted > 0 && row.to_host.predicted == 0;
    Hull host;
    const Times cpu =
        timed([&] { host = convex_hull(here, on(Backend::cpu)); }, only_there ? 0 : repeats);
    if (!only_there) {
      Hull device;
      json["to_host"] =
          told(timed([&] { device = convex_hull(view, on(Backend::cuda)); }), row.to_host);
      require_same(device, host);
      json["on_device_seconds"] = device.statistics.cull_seconds;
      json["survivors"] = device.statistics.survivors;
      json["filter"] = filter_name(device.statistics.filter);
      json["reason"] = device.statistics.cull_reason;
    }
    if (row.left_there.predicted > 0) {
      DeviceHull left;
      json["left_there"] = told(
          timed([&] { left = convex_hull_on_device(view, on(Backend::cuda)); }), row.left_there);
      if (left.vertex_count != host.vertices.size() || left.volume != host.volume)
        throw std::runtime_error("the hull left on the device is not the CPU's");
    }
    json["cpu"] = told(cpu);
    json["threads"] = host.statistics.threads;
    if (row.d == 3) json["surface"] = surface_stages(view);
    return json;
  }

  ordered_json hull_from_host(const Row& row) const {
    const std::vector<float> rows = points_of_row(row);
    const std::uint64_t n = rows.size() / 3;
    const auto here = PointView::row_major(rows.data(), n, 3);
    const auto map = map_of(rows, 3);
    const Options options;
    const internal::Run run(options);
    const double pass = wall([&] { (void)survivors_there(map->table(), here, run); });
    Hull device, host;
    const Times d = timed([&] { device = convex_hull(here, on(Backend::cuda)); });
    const Times h = timed([&] { host = convex_hull(here, on(Backend::cpu)); });
    require_same(device, host);
    ordered_json json = head_of(row, n);
    json["to_host"] = told(d, row.to_host);
    json["cpu"] = told(h);
    json["reason"] = device.statistics.cull_reason;
    json["pass_seconds"] = pass;
    json["pass_bytes_per_second"] = 12 * static_cast<double>(n) / pass;
    return json;
  }

  ordered_json hulls_on_threads() const {
    constexpr unsigned count = 4;
    const std::uint64_t n = scaled(2e6);
    const std::vector<float> rows = points_of("ball", n, 3);
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

  /// Frames of points that are on the device already, each compared with the CPU's.
  ordered_json frames(const Row& row) const {
    constexpr unsigned frames = 30, measured = 12;
    const std::uint64_t n = scaled(row.count);
    const MovingPoints moving(row.shape, row.motion, n, 3, frames);
    std::vector<double> numbers(n * 3);
    const CudaStream stream;
    const DeviceArray<float> there(n * 3, stream.get());
    const auto view = DevicePointView::row_major(there.data(), n, 3, stream.get());
    HullTracker device(on(Backend::cuda)), host(on(Backend::cpu));
    const Options options = on(Backend::cuda);
    const internal::Run run(options);
    std::shared_ptr<LastSurface> last;
    std::vector<double> on_device, on_host;
    ordered_json surfaces, json = head_of(row, n);
    for (unsigned f = 0; f < measured; ++f) {
      moving.frame(f, numbers.data());
      const std::vector<float> rows(numbers.begin(), numbers.end());
      upload(there.data(), rows.data(), rows.size(), stream.get());
      synchronise(stream.get(), "copying");
      on_device.push_back(seconds_of([&] { (void)device.update(view); }));
      on_host.push_back(
          seconds_of([&] { (void)host.update(PointView::row_major(rows.data(), n, 3)); }));
      require_same(device.hull(), host.hull());
      std::vector<internal::PseudoHullRound> rounds;
      const StarHullThere found = star_hull_there(
          view, run, {.place = internal::HullPlace::nowhere, .last = &last, .rounds = &rounds});
      surfaces.push_back(counts_of(found.counts, rounds, n));
      surfaces.back()["method"] = device.report().method;
      surfaces.back()["growth_seconds"] = found.counts.growth_seconds;
      surfaces.back()["flip_seconds"] = found.counts.flip_seconds;
    }
    const auto later = [](const std::vector<double>& of) {
      return times_of(of.front(), {of.begin() + 2, of.end()});
    };
    json["motion"] = row.motion;
    json["to_host"] = told(later(on_device), row.to_host);
    json["cpu"] = told(later(on_host));
    json["surfaces"] = surfaces;
    return json;
  }

  /// 100,000 sets of 50 points of a ball: the kernels by events, both kinds of results, and the
  /// CPU.
  ordered_json batch(const Row& row) const {
    constexpr std::uint64_t size = 50;
    const unsigned d = row.d;
    const std::uint64_t sets = scaled(row.count) / size;
    const std::vector<float> rows = points_of("ball", sets * size, d);
    std::vector<std::uint64_t> offsets(sets + 1);
    for (std::uint64_t i = 0; i <= sets; ++i) offsets[i] = i * size;
    const CudaStream stream;
    const DeviceArray<float> points(rows.size(), stream.get());
    upload(points.data(), rows.data(), rows.size(), stream.get());
    const auto there = DevicePointView::row_major(points.data(), sets * size, d, stream.get());
    const auto here = PointView::row_major(rows.data(), sets * size, d);

    const DeviceArray<std::uint64_t> starts(offsets.size(), stream.get());
    upload(starts.data(), offsets.data(), offsets.size(), stream.get());
    const DeviceArray<SetCounts> counts(sets, stream.get());
    const DeviceArray<std::uint16_t> vertices(sets * size, stream.get()),
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
    const Times to_host =
        timed([&] { device = convex_hulls(there, offsets.data(), sets, on(Backend::cuda)); });
    DeviceHullBatch left;
    const Times on_device = timed(
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
            {"to_host", told(to_host, row.to_host)},
            {"left_there", told(on_device, row.left_there)},
            {"measures_kernel_seconds", measuring},
            {"left_there_with_planes_and_measures_seconds", with_measures},
            {"cpu_seconds", cpu}};
  }

  /// Queries for points in and around a ball to the hull of some of its points.
  ordered_json questions() const {
    const std::uint64_t n = scaled(1e6);
    std::vector<float> rows = points_of("ball", n, 3);
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
    std::vector<float> rows = points_of("ball", n, 3);
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
  std::string only_;
  bench::JsonLines lines_;
};

[[noreturn]] void bad_usage(const std::string& what) {
  std::fprintf(
      stderr,
      "gpu_passes: %s\nusage: gpu_passes [--out FILE] [--scale S] [--seconds T] [--part PART]\n",
      what.c_str());
  std::exit(2);
}

}  // namespace

int main(int argc, char** argv) {
  std::string file, part;
  double scale = 1, seconds = 300;
  for (int i = 1; i < argc; ++i) {
    const std::string a = argv[i];
    if (i + 1 >= argc) bad_usage(a + " is unknown or wants a value");
    const char* value = argv[++i];
    if (a == "--out")
      file = value;
    else if (a == "--scale")
      scale = std::atof(value);
    else if (a == "--part")
      part = value;
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
    Passes passes(scale, seconds, file, part);
    passes.run();
    return passes.failed() ? 1 : 0;
  } catch (const std::exception& e) {
    std::fprintf(stderr, "gpu_passes: %s\n", e.what());
    return 1;
  }
}
