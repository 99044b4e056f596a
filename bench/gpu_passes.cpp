// Times of a device's steps for each kind of points: gpu_passes [--out FILE] [--scale S] [--seconds
// T]
//
// Prints one JSON object per line as soon as it is measured, so that an interrupted run reports
// what it has done. Kernels are timed by events of their stream, everything else by the host's
// clock; medians of five after a first run that is not counted. Parts that do not fit into the
// device's memory, or would start after T seconds, are skipped and reported as skipped. Exit status
// 5: no device.
#include <cuda_runtime_api.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <random>
#include <string>
#include <thread>
#include <vector>

#include "cuda/gauge.hpp"
#include "cuda/kernels/gauge_kernel.hpp"
#include "cuda/kernels/pseudo_hull.hpp"
#include "cuda/kernels/set_hulls_kernel.hpp"
#include "cuda/runtime.hpp"
#include "cullhull/cullhull.hpp"
#include "cullhull/device_points.hpp"
#include "filter/gauge/gauge_map.hpp"
#include "flow/sample_map.hpp"
#include "geometry/gather.hpp"

namespace {

namespace cuda = cullhull::internal::cuda;
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

constexpr unsigned repeats = 5;

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

/// Time of the work that `work` queues on the stream, by events.
double by_events(cudaStream_t stream, const std::function<void()>& work) {
  cudaEvent_t begin = nullptr, end = nullptr;
  cuda::check(cudaEventCreate(&begin), "making an event");
  cuda::check(cudaEventCreate(&end), "making an event");
  std::vector<double> times;
  for (unsigned k = 0; k <= repeats; ++k) {
    cuda::check(cudaEventRecord(begin, stream), "recording an event");
    work();
    cuda::check(cudaEventRecord(end, stream), "recording an event");
    cuda::check(cudaEventSynchronize(end), "waiting for an event");
    float milliseconds = 0;
    cuda::check(cudaEventElapsedTime(&milliseconds, begin, end), "reading an event");
    if (k > 0) times.push_back(1e-3 * milliseconds);
  }
  (void)cudaEventDestroy(begin);
  (void)cudaEventDestroy(end);
  return median(times);
}

/// Points uniform in the ball; at most a million different ones, repeated as needed.
template <class T>
std::vector<T> ball(unsigned d, std::uint64_t n) {
  std::mt19937_64 random(1);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> unit;
  std::vector<T> rows(n * d);
  for (std::uint64_t i = 0; i < n; ++i) {
    double x[8], square = 0;
    for (unsigned j = 0; j < d; ++j) x[j] = normal(random), square += x[j] * x[j];
    const double scale = std::pow(unit(random), 1.0 / d) / std::sqrt(square);
    for (unsigned j = 0; j < d; ++j) rows[i * d + j] = static_cast<T>(x[j] * scale);
  }
  return rows;
}

class Passes {
 public:
  Passes(double scale, double seconds, const std::string& file)
      : scale_(scale), seconds_(seconds), start_(Clock::now()) {
    if (!file.empty()) out_.open(file, std::ios::app);
  }

  void run() {
    part("device", [&] { return about(); });
    part("copy on the device", [&] { return copy_rate(); });
    part("link, pinned memory", [&] { return link(); });
    for (const unsigned d : {3U, 2U, 4U, 5U, 6U})
      part("pass, f32", [&] { return pass<float>(d, Layout::packed); });
    part("pass, f64", [&] { return pass<double>(3, Layout::packed); });
    part("pass, f32, columns", [&] { return pass<float>(3, Layout::columns); });
    part("pass, f32, misaligned", [&] { return pass<float>(3, Layout::misaligned); });
    part("hull, points on the device", [&] { return hull_there(); });
    part("hull, points on the host", [&] { return hull_from_host(); });
    part("hulls on threads beside one another", [&] { return hulls_on_threads(); });
    part("pseudo-hull", [&] { return pseudo_hull(); });
    part("moving points", [&] { return tracker(); });
    for (const unsigned d : {2U, 3U}) part("batch of sets of 50", [&] { return batch(d); });
    part("questions to a hull", [&] { return questions(); });
    part("pass, more than 2^31 points", [&] { return many_points(); });
  }
  bool failed() const { return failed_; }

 private:
  enum class Layout { packed, columns, misaligned };

  std::uint64_t scaled(double n) const {
    return std::max<std::uint64_t>(5000, static_cast<std::uint64_t>(n * scale_));
  }

  void part(const char* name, const std::function<ordered_json()>& work) {
    ordered_json line;
    line["part"] = name;
    if (seconds_since(start_) > seconds_) {
      line["left_out"] = "no time left";
    } else {
      try {
        line.update(work());
      } catch (const cuda::OutOfMemory& e) {
        line["left_out"] = e.what();
      } catch (const std::exception& e) {
        line["error"] = e.what();
        failed_ = true;
      }
    }
    line["at_seconds"] = seconds_since(start_);
    const std::string text = line.dump();
    std::printf("%s\n", text.c_str());
    std::fflush(stdout);
    if (out_.is_open()) out_ << text << std::endl;
  }

  ordered_json about() const {
    const CudaStatus status = cuda_status();
    return {{"name", status.device},           {"compute_capability", status.compute_capability},
            {"driver", status.driver_version}, {"runtime", status.runtime_version},
            {"memory", status.memory_bytes},   {"processors", cuda::device().multiprocessors}};
  }

  /// Bytes read plus bytes written, per second.
  ordered_json copy_rate() {
    const std::uint64_t bytes = scaled(1 << 30);
    const cuda::Stream stream;
    const cuda::DeviceArray<std::byte> from(bytes, stream.get()), to(bytes, stream.get());
    cuda::check(cudaMemsetAsync(from.data(), 1, bytes, stream.get()), "clearing");
    const double took = by_events(stream.get(), [&] {
      cuda::check(
          cudaMemcpyAsync(to.data(), from.data(), bytes, cudaMemcpyDeviceToDevice, stream.get()),
          "copying");
    });
    copy_rate_ = 2 * static_cast<double>(bytes) / took;
    return {{"bytes_per_second", copy_rate_}};
  }

  ordered_json link() const {
    const std::uint64_t bytes = scaled(1 << 28);
    const cuda::Stream stream;
    const cuda::DeviceArray<std::byte> there(bytes, stream.get());
    const cuda::PinnedArray<std::byte> here(bytes);
    std::fill_n(here.data(), bytes, std::byte{1});
    const double to = by_events(stream.get(), [&] {
      cuda::check(
          cudaMemcpyAsync(there.data(), here.data(), bytes, cudaMemcpyHostToDevice, stream.get()),
          "copying");
    });
    const double from = by_events(stream.get(), [&] {
      cuda::check(
          cudaMemcpyAsync(here.data(), there.data(), bytes, cudaMemcpyDeviceToHost, stream.get()),
          "copying");
    });
    const auto b = static_cast<double>(bytes);
    return {{"to_device_bytes_per_second", b / to}, {"from_device_bytes_per_second", b / from}};
  }

  /// `n` values on the device: the given values, repeated.
  template <class T>
  cuda::DeviceArray<T> repeated(const std::vector<T>& values, std::uint64_t n,
                                cudaStream_t stream) const {
    cuda::DeviceArray<T> all(n, stream);
    std::uint64_t have = std::min<std::uint64_t>(n, values.size());
    cuda::upload(all.data(), values.data(), have, stream);
    while (have < n) {
      const std::uint64_t more = std::min(have, n - have);
      cuda::check(cudaMemcpyAsync(all.data() + have, all.data(), more * sizeof(T),
                                  cudaMemcpyDeviceToDevice, stream),
                  "copying");
      have += more;
    }
    cuda::synchronise(stream, "copying");
    return all;
  }

  template <class T>
  static std::unique_ptr<internal::GaugeMap> map_of(const std::vector<T>& rows, unsigned d) {
    const Options options;
    const auto run = internal::Run(options).with_threads(1).with_budget(std::uint64_t{4} << 30);
    const auto view = PointView::row_major(rows.data(), rows.size() / d, d);
    internal::SampledPoints sample{view.count, d,
                                   [&](const std::vector<std::uint64_t>& ids) {
      return internal::gather_points(view, ids.data(), ids.size(), run);
                                   }};
    auto sampled = internal::map_of_sample(sample, internal::Insist::yes,
                                           cuda::most_gauge_nodes(cuda::device()), run);
    if (sampled.map == nullptr) throw std::runtime_error("no map: " + sampled.reason);
    return std::move(sampled.map);
  }

  /// The kernel alone, by events; and including counting and listing, by the host's clock.
  ordered_json time_pass(const internal::GaugeMap& map, const DevicePointView& view) const {
    const auto stream = static_cast<cudaStream_t>(view.stream);
    const internal::GaugeTable& table = map.table();
    const cuda::DeviceArray<float> nodes(table.nodes.size(), stream);
    cuda::upload(nodes.data(), table.nodes.data(), table.nodes.size(), stream);
    const cuda::DeviceArray<std::uint32_t> mask(cuda::mask_room(view.count), stream);
    const double kernel = by_events(stream, [&] {
      cuda::check(cuda::gauge_mask(table, nodes.data(), view, mask.data(), cuda::device(), stream),
                  "culling");
    });
    std::uint64_t kept = 0;
    const double listed = wall([&] { kept = cuda::survivors_of_device_points(table, view).count; });
    const auto n = static_cast<double>(view.count);
    const double bytes = n * view.dimension * static_cast<double>(scalar_size(view.scalar));
    ordered_json json = {{"dimension", view.dimension},          {"count", view.count},
                         {"nodes", table.nodes.size()},          {"kernel_seconds", kernel},
                         {"points_per_second", n / kernel},      {"with_list_seconds", listed},
                         {"kept", static_cast<double>(kept) / n}};
    if (copy_rate_ > 0) json["share_of_copy"] = bytes / kernel / copy_rate_;
    return json;
  }

  template <class T>
  ordered_json pass(unsigned d, Layout layout) const {
    const std::vector<T> rows = ball<T>(d, scaled(1e6));
    const auto map = map_of(rows, d);
    const std::uint64_t n = scaled(layout == Layout::packed && d == 3 ? 1e8 : 3e7);
    const cuda::Stream stream;
    const bool shifted = layout == Layout::misaligned;
    const cuda::DeviceArray<T> there = repeated(rows, n * d + (shifted ? d : 0), stream.get());
    // Read as columns, this memory holds other points in the same box; the pass takes as long.
    DevicePointView view =
        layout == Layout::columns
            ? DevicePointView::column_major(there.data(), n, d, stream.get())
            : DevicePointView::row_major(there.data() + (shifted ? d : 0), n, d, stream.get());
    return time_pass(*map, view);
  }

  ordered_json many_points() const {
    const std::uint64_t n = scale_ < 1 ? scaled(1e6) : (std::uint64_t{1} << 31) + 1001;
    const std::vector<float> rows = ball<float>(3, scaled(1e6));
    const auto map = map_of(rows, 3);
    const cuda::Stream stream;
    const cuda::DeviceArray<float> there = repeated(rows, n * 3, stream.get());
    return time_pass(*map, DevicePointView::row_major(there.data(), n, 3, stream.get()));
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
  ordered_json hull_there() const {
    const std::uint64_t n = scaled(8e6);
    const std::vector<float> rows = ball<float>(3, n);
    const cuda::Stream stream;
    const cuda::DeviceArray<float> there = repeated(rows, n * 3, stream.get());
    const auto view = DevicePointView::row_major(there.data(), n, 3, stream.get());
    const auto here = PointView::row_major(rows.data(), n, 3);
    Hull device, host;
    const double d = wall([&] { device = convex_hull(view, on(Backend::cuda)); });
    const double h = wall([&] { host = convex_hull(here, on(Backend::cpu)); });
    require_same(device, host);
    return {{"count", n},
            {"device_seconds", d},
            {"of_that_cull", device.statistics.cull_seconds},
            {"survivors", device.statistics.survivors},
            {"method", device.statistics.filter},
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
    const double pass =
        wall([&] { (void)cuda::survivors_of_host_points(map->table(), here, run); });
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
    std::vector<cuda::Stream> streams(count);
    std::vector<cuda::DeviceArray<float>> there;
    for (const cuda::Stream& s : streams) there.push_back(repeated(rows, n * 3, s.get()));
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
    const cuda::Stream stream;
    const cuda::DeviceArray<float> there = repeated(rows, n * 3, stream.get());
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
    const cuda::Stream stream;
    const cuda::DeviceArray<float> there(n * 3, stream.get());
    HullTracker device(on(Backend::cuda)), host(on(Backend::cpu));
    std::vector<double> on_device, on_host;
    for (unsigned f = 0; f < frames; ++f) {
      for (std::uint64_t i = 0; i < n; ++i) {
        float* p = rows.data() + 3 * i;
        const float x = p[0], y = p[1];
        p[0] = x - 0.01F * y;
        p[1] = y + 0.01F * x;
      }
      cuda::upload(there.data(), rows.data(), rows.size(), stream.get());
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

  /// 100,000 sets of 50 points of a ball: the kernel by events, both kinds of results, and the CPU.
  ordered_json batch(unsigned d) const {
    constexpr std::uint64_t size = 50;
    const auto sets = std::max<std::uint64_t>(200, static_cast<std::uint64_t>(1e5 * scale_));
    const std::vector<float> rows = ball<float>(d, sets * size);
    std::vector<std::uint64_t> offsets(sets + 1);
    for (std::uint64_t i = 0; i <= sets; ++i) offsets[i] = i * size;
    const cuda::Stream stream;
    const cuda::DeviceArray<float> points(rows.size(), stream.get());
    cuda::upload(points.data(), rows.data(), rows.size(), stream.get());
    const auto there = DevicePointView::row_major(points.data(), sets * size, d, stream.get());
    const auto here = PointView::row_major(rows.data(), sets * size, d);

    const cuda::DeviceArray<std::uint64_t> starts(offsets.size(), stream.get());
    cuda::upload(starts.data(), offsets.data(), offsets.size(), stream.get());
    const cuda::DeviceArray<std::uint16_t> counts(sets, stream.get());
    const cuda::DeviceArray<std::uint8_t> vertices(sets * size, stream.get()),
        simplices(sets * size * cuda::simplex_room(d), stream.get());
    const cuda::WarpSets task{starts.data(), static_cast<std::uint32_t>(sets), counts.data(),
                              vertices.data(), simplices.data()};
    const double kernel = by_events(stream.get(), [&] {
      cuda::check(cuda::find_set_hulls(there, task, 33, 64, stream.get()), "hulling sets");
    });
    HullBatch device, host;
    const double to_host =
        wall([&] { device = convex_hulls(there, offsets.data(), sets, on(Backend::cuda)); });
    DeviceHullBatch left;
    const double on_device = wall(
        [&] { left = convex_hulls_on_device(there, offsets.data(), sets, on(Backend::cuda)); });
    const double cpu = wall([&] { host = convex_hulls(here, offsets); });
    if (device.vertices != host.vertices || device.volumes != host.volumes ||
        left.vertex_count != host.vertices.items.size())
      throw std::runtime_error("the device's batch is not the CPU's");
    return {{"dimension", d},
            {"sets", sets},
            {"kernel_seconds", kernel},
            {"to_host_seconds", to_host},
            {"left_there_seconds", on_device},
            {"cpu_seconds", cpu}};
  }

  /// Queries for points in and around a ball to the hull of some of its points.
  ordered_json questions() const {
    const std::uint64_t n = scaled(1e6);
    std::vector<float> rows = ball<float>(3, n);
    const auto some = PointView::row_major(rows.data(), std::min<std::uint64_t>(n, 100000), 3);
    const HullQuery query(some, convex_hull(some));
    for (float& v : rows) v *= 1.1F;
    const cuda::Stream stream;
    const cuda::DeviceArray<float> points(rows.size(), stream.get());
    cuda::upload(points.data(), rows.data(), rows.size(), stream.get());
    const auto there = DevicePointView::row_major(points.data(), n, 3, stream.get());
    const auto here = PointView::row_major(rows.data(), n, 3);
    std::vector<std::uint8_t> device(n), host(n);
    std::vector<std::uint64_t> device_vertices(n), host_vertices(n);
    const double contains = wall([&] { query.contains(there, device.data(), on(Backend::cuda)); });
    const double cpu_contains = wall([&] { query.contains(here, host.data()); });
    const double supports =
        wall([&] { query.supports(there, device_vertices.data(), on(Backend::cuda)); });
    const double cpu_supports = wall([&] { query.supports(here, host_vertices.data()); });
    if (device != host || device_vertices != host_vertices)
      throw std::runtime_error("the device's answers are not the CPU's");
    return {{"count", n},
            {"contains_seconds", contains},
            {"cpu_contains_seconds", cpu_contains},
            {"supports_seconds", supports},
            {"cpu_supports_seconds", cpu_supports}};
  }

  double scale_, seconds_, copy_rate_ = 0;
  Clock::time_point start_;
  std::ofstream out_;
  bool failed_ = false;
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
