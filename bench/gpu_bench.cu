// The GPU compared with its limits, with our CPU and with Qhull, in one run: gpu_bench [--out FILE]
// [--scale S] [--repeat K] [--seconds T] [--no-qhull]
//
// Prints one line of JSON for each figure as soon as it is known, and appends it to FILE; Qhull,
// which takes most of the time, comes last. Points are generated on the device and stay there:
// single precision, packed rows. Times are medians on the host's clock, from the call to its result
// on the host; the first call, which loads code and fills memory pools, is not counted. Our CPU
// gets a copy of the same points in the host's memory and all of its threads, Qhull the same points
// as doubles and one core. Parts that would start after T seconds are left out. Exit status 1: a
// hull was not the device's, or a part failed; 5: no device.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <vector>

#include "cuda/gauge.hpp"
#include "cuda/kernels/gauge_kernel.hpp"
#include "cuda/kernels/pseudo_hull.hpp"
#include "cuda/runtime.hpp"
#include "cullhull/cullhull.hpp"
#include "cullhull/device_points.hpp"
#include "cullhull/version.hpp"
#include "device_rates.hpp"
#include "flow/sample_map.hpp"
#include "json_lines.hpp"
#include "qhull.hpp"
#include "timing.hpp"

namespace {

using namespace cullhull::internal;
using cullhull::DevicePointView;
using nlohmann::ordered_json;

struct Settings {
  double scale = 1;
  unsigned repeat = 5;
  bool qhull = true;
  double seconds = 300;
  std::string out;
};

enum class Shape { ball, octahedron };

struct Workload {
  const char* name;
  Shape shape;
  unsigned dimension;
  std::uint64_t count;
};

// The sets of the paper.
constexpr Workload end_to_end[] = {
    {"ball-3d-8M", Shape::ball, 3, 8'000'000},
    {"octahedron-3d-15M", Shape::octahedron, 3, 15'000'000},
    {"ball-3d-10M", Shape::ball, 3, 10'000'000},
    {"ball-3d-30M", Shape::ball, 3, 30'000'000},
    {"ball-3d-50M", Shape::ball, 3, 50'000'000},
    {"ball-4d-8M", Shape::ball, 4, 8'000'000},
};

/// A hash of a counter, which gives every point its own random stream (Steele, Lea, Flood 2014,
/// SplitMix64).
struct Random {
  std::uint64_t state;
  __device__ std::uint64_t bits() {
    std::uint64_t z = state += 0x9E3779B97F4A7C15ULL;
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9ULL;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EBULL;
    return z ^ (z >> 31);
  }
  /// Uniform in (0, 1).
  __device__ double unit() { return (static_cast<double>(bits() >> 12) + 0.5) * 0x1p-52; }
};

/// Uniform in the ball, or in the octahedron (the unit ball of the sum norm).
__global__ void make_points(Shape shape, unsigned d, std::uint64_t n, std::uint64_t seed,
                            float* out) {
  const std::uint64_t stride = std::uint64_t{gridDim.x} * blockDim.x;
  for (std::uint64_t i = std::uint64_t{blockIdx.x} * blockDim.x + threadIdx.x; i < n; i += stride) {
    Random random{(seed << 48) + i * 0xD1342543DE82EF95ULL};
    double p[4] = {}, norm = 0;
    for (unsigned k = 0; k < d && k < 4; ++k) {
      const double length = -log(random.unit());
      if (shape == Shape::octahedron) {
        p[k] = random.bits() >> 63 != 0 ? length : -length;
        norm += length;
      } else {
        p[k] = sqrt(2 * length) * cospi(2 * random.unit());
        norm += p[k] * p[k];
      }
    }
    if (shape == Shape::ball) norm = sqrt(norm);
    const double radius = pow(random.unit(), 1.0 / d) / norm;
    for (unsigned k = 0; k < d && k < 4; ++k) out[i * d + k] = static_cast<float>(p[k] * radius);
  }
}

class Points {
 public:
  Points(Shape shape, unsigned d, std::uint64_t n) : d_(d), n_(n), data_(n * d, stream_.get()) {
    make_points<<<this_device().multiprocessors * 16, 256, 0, stream_.get()>>>(shape, d, n, 1,
                                                                               data_.data());
    check(cudaGetLastError(), "making points");
    synchronise(stream_.get(), "making points");
  }
  DevicePointView view() const {
    return DevicePointView::row_major(data_.data(), n_, d_, stream_.get());
  }
  std::vector<float> rows() const {
    std::vector<float> rows(n_ * d_);
    download(rows.data(), data_.data(), rows.size(), stream_.get());
    return rows;
  }

 private:
  CudaStream stream_;
  unsigned d_;
  std::uint64_t n_;
  DeviceArray<float> data_;
};

/// The times of `repeat` calls, after one that is not counted.
template <class Work>
std::vector<double> timed(unsigned repeat, const Work& work) {
  work();
  std::vector<double> times;
  for (unsigned k = 0; k < repeat; ++k) times.push_back(cullhull::bench::seconds_of(work));
  return times;
}

std::uint64_t scaled(std::uint64_t count, double scale) {
  return std::max<std::uint64_t>(
      1000, static_cast<std::uint64_t>(std::llround(static_cast<double>(count) * scale)));
}

ordered_json times_of(std::uint64_t n, const std::vector<double>& times) {
  const double seconds = cullhull::bench::median(times);
  return {{"seconds", seconds},
          {"seconds_all", times},
          {"points_per_second", static_cast<double>(n) / seconds}};
}

double share(std::uint64_t part, std::uint64_t whole) {
  return static_cast<double>(part) / static_cast<double>(whole);
}

class Bench {
 public:
  explicit Bench(const Settings& settings)
      : settings_(settings), lines_(settings.out, settings.seconds) {}

  int run() {
    lines_.part({{"part", "machine"}}, [&] { return machine(); });
    for (const Workload& w : end_to_end) whole_hull(w);
    filters("ball-3d-8M", 3, 8'000'000);
    filters("ball-3d-100M", 3, 100'000'000);
    filters("ball-4d-8M", 4, 8'000'000);
    if (settings_.qhull) {
      std::vector<Compared*> order;
      for (Compared& c : compared_) order.push_back(&c);
      std::stable_sort(order.begin(), order.end(), [](const Compared* a, const Compared* b) {
        return a->work.dimension * a->work.count * a->vertices <
               b->work.dimension * b->work.count * b->vertices;
      });
      for (const Compared* c : order) qhull(*c);
    }
    return lines_.failed() ? 1 : 0;
  }

 private:
  /// What is known of a whole hull when Qhull's turn comes.
  struct Compared {
    Workload work;
    std::uint64_t vertices = 0;
    double volume = 0, device_seconds = 0, cpu_seconds = 0;
  };

  ordered_json machine() {
    const cullhull::CudaStatus status = cullhull::cuda_status();
    const DeviceRates rates = measure_device();
    copy_rate_ = rates.copy;
    return {{"version", CULLHULL_VERSION},
            {"device", status.device},
            {"compute_capability", status.compute_capability},
            {"driver", status.driver_version},
            {"runtime", status.runtime_version},
            {"link_bytes_per_second", rates.link_pinned},
            {"link_pageable_bytes_per_second", rates.link_pageable},
            {"copy_bytes_per_second", rates.copy}};
  }

  static ordered_json line(const char* part, const char* name, unsigned d, std::uint64_t n) {
    return {{"part", part}, {"workload", name}, {"dimension", d}, {"count", n}};
  }

  /// The share of the copy bandwidth at which every coordinate is read once.
  void add_share_of_copy(ordered_json& json, unsigned d) const {
    if (copy_rate_ > 0)
      json["share_of_copy"] =
          json["points_per_second"].get<double>() * d * sizeof(float) / copy_rate_;
  }

  /// Both filters, and the gauge map's pass without building the map.
  void filters(const char* name, unsigned d, std::uint64_t count) {
    const std::uint64_t n = scaled(count, settings_.scale);
    lines_.part(line("filter, gauge map", name, d, n), [&] {
      const Points points(Shape::ball, d, n);
      cullhull::Options options;
      options.backend = cullhull::Backend::cuda;
      options.cull = cullhull::CullMethod::gauge;
      cullhull::Survivors survivors;
      ordered_json json = times_of(
          n, timed(settings_.repeat, [&] { survivors = cullhull::cull(points.view(), options); }));
      json["filter"] = cullhull::filter_name(survivors.filter);
      json["kept"] = share(survivors.size(n), n);
      add_share_of_copy(json, d);
      return json;
    });
    lines_.part(line("filter, the gauge map's pass", name, d, n), [&] { return pass(d, n); });
    lines_.part(line("filter, pseudo-hull", name, d, n), [&] {
      const Points points(Shape::ball, d, n);
      const cullhull::Options defaults;
      const cullhull::internal::Run run(defaults);
      std::vector<std::uint64_t> kept;
      std::vector<cullhull::internal::PseudoHullRound> rounds;
      ordered_json json = times_of(n, timed(settings_.repeat, [&] {
                                     kept = cullhull::internal::pseudo_hull_survivors_cuda(
                                         points.view(), {}, run.control, &rounds);
                                   }));
      json["kept"] = share(kept.size(), n);
      json["rounds"] = rounds.size();
      return json;
    });
  }

  ordered_json pass(unsigned d, std::uint64_t n) const {
    const Points points(Shape::ball, d, n);
    const DevicePointView view = points.view();
    const cullhull::Options defaults;
    const cullhull::internal::Run run(defaults);
    cullhull::internal::SampledPoints sample;
    sample.count = n;
    sample.dimension = d;
    sample.gather = [&](const std::vector<std::uint64_t>& ids) {
      return download_points(view, ids.data(), ids.size(), run);
    };
    const auto sampled = cullhull::internal::map_of_sample(sample, cullhull::internal::Insist::yes,
                                                           most_map_nodes(), run);
    if (sampled.map == nullptr) throw std::runtime_error("no map: " + sampled.reason);
    std::uint64_t kept = n;
    ordered_json json = times_of(
        n, timed(settings_.repeat,
                 [&] { kept = survivors_of_device_points(sampled.map->table(), view).count; }));
    json["kept"] = share(kept, n);
    add_share_of_copy(json, d);
    return json;
  }

  /// From points on the device to the exact hull, and our CPU on a copy of them.
  void whole_hull(const Workload& w) {
    const std::uint64_t n = scaled(w.count, settings_.scale);
    lines_.part(line("hull", w.name, w.dimension, n), [&] {
      const Points points(w.shape, w.dimension, n);
      cullhull::Options options;
      options.backend = cullhull::Backend::cuda;
      cullhull::Hull there, here;
      ordered_json json = times_of(n, timed(settings_.repeat, [&] {
                                     there = cullhull::convex_hull(points.view(), options);
                                   }));
      json["vertices"] = there.vertices.size();
      json["facets"] = there.facet_count();
      json["survivors"] = there.statistics.survivors;
      const std::vector<float> rows = points.rows();
      const auto view = cullhull::PointView::row_major(rows.data(), n, w.dimension);
      options.backend = cullhull::Backend::cpu;
      const double cpu = cullhull::bench::median(
          timed(settings_.repeat, [&] { here = cullhull::convex_hull(view, options); }));
      json["cpu_seconds"] = cpu;
      json["cpu_threads"] = here.statistics.threads;
      if (here.vertices != there.vertices || here.volume != there.volume)
        throw std::runtime_error("the device's hull is not the CPU's");
      compared_.push_back({w, there.vertices.size(), there.volume, json["seconds"], cpu});
      return json;
    });
  }

  /// Qhull on the same points; both must find the same hull.
  void qhull(const Compared& c) {
    const std::uint64_t n = scaled(c.work.count, settings_.scale);
    lines_.part(line("Qhull", c.work.name, c.work.dimension, n), [&]() -> ordered_json {
      const Points points(c.work.shape, c.work.dimension, n);
      const std::vector<float> rows = points.rows();
      const std::vector<double> doubles(rows.begin(), rows.end());
      cullhull::bench::ChildLimits limits;
      limits.seconds = std::max(5.0, lines_.seconds_left());
      const auto rival = cullhull::bench::run_qhull(
          cullhull::PointView::row_major(doubles.data(), n, c.work.dimension), limits);
      if (!rival) return {{"left_out", "no Qhull, or it failed"}};
      if (!rival->finished)
        return {{"left_out", "not done within " + std::to_string(limits.seconds) + " s"}};
      ordered_json json = {{"qhull_seconds", rival->seconds},
                           {"device_seconds", c.device_seconds},
                           {"cpu_seconds", c.cpu_seconds},
                           {"qhull_over_device", rival->seconds / c.device_seconds},
                           {"qhull_over_cpu", rival->seconds / c.cpu_seconds},
                           {"vertices", rival->vertices},
                           {"volume_ratio", rival->volume / c.volume}};
      const bool agrees =
          rival->vertices == c.vertices && std::fabs(rival->volume / c.volume - 1) < 1e-9;
      json["agrees"] = agrees;
      if (!agrees) lines_.fail();
      return json;
    });
  }

  const Settings& settings_;
  cullhull::bench::JsonLines lines_;
  double copy_rate_ = 0;
  std::vector<Compared> compared_;
};

Settings parse(int argc, char** argv) {
  Settings s;
  for (int i = 1; i < argc; ++i) {
    const std::string a = argv[i];
    const auto value = [&]() -> const char* {
      if (i + 1 < argc) return argv[++i];
      std::fprintf(stderr, "gpu_bench: %s needs a value\n", a.c_str());
      std::exit(2);
    };
    if (a == "--scale") {
      s.scale = std::atof(value());
    } else if (a == "--repeat") {
      s.repeat = static_cast<unsigned>(std::max(1, std::atoi(value())));
    } else if (a == "--seconds") {
      s.seconds = std::atof(value());
    } else if (a == "--out") {
      s.out = value();
    } else if (a == "--no-qhull") {
      s.qhull = false;
    } else {
      std::fprintf(stderr, "gpu_bench: unknown option %s\n", a.c_str());
      std::exit(2);
    }
  }
  if (!(s.scale > 0)) {
    std::fprintf(stderr, "gpu_bench: --scale must be positive\n");
    std::exit(2);
  }
  return s;
}

int run(int argc, char** argv) {
  const Settings settings = parse(argc, argv);
  const cullhull::CudaStatus status = cullhull::cuda_status();
  if (!status.available) {
    std::fprintf(stderr, "gpu_bench: %s\n", status.reason.c_str());
    return 5;
  }
  return Bench(settings).run();
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return run(argc, argv);
  } catch (const std::exception& e) {
    std::fprintf(stderr, "gpu_bench: %s\n", e.what());
    return 1;
  }
}
