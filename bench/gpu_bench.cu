// The GPU compared with its limits and with Qhull, in one run: gpu_bench [--json FILE] [--scale S]
// [--repeat K] [--no-qhull]
//
// Points are generated on the device and stay there: single precision, packed rows. Times are
// medians on the host's clock, from the call to its result on the host; the first call, which loads
// code and fills memory pools, is not counted. Qhull gets the same points as doubles, and one core.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "cuda/gauge.hpp"
#include "cuda/kernels/gauge_kernel.hpp"
#include "cuda/kernels/pseudo_hull.hpp"
#include "cuda/runtime.hpp"
#include "cullhull/cullhull.hpp"
#include "cullhull/device_points.hpp"
#include "cullhull/io.hpp"
#include "cullhull/version.hpp"
#include "flow/sample_map.hpp"
#include "machine.hpp"
#include "qhull.hpp"
#include "timing.hpp"

namespace {

namespace cuda = cullhull::internal::cuda;
using cullhull::DevicePointView;
using nlohmann::ordered_json;

struct Settings {
  double scale = 1;
  unsigned repeat = 5;
  bool qhull = true;
  std::string json;
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
    make_points<<<cuda::device().multiprocessors * 16, 256, 0, stream_.get()>>>(shape, d, n, 1,
                                                                                data_.data());
    cuda::check(cudaGetLastError(), "making points");
    cuda::synchronise(stream_.get(), "making points");
  }
  DevicePointView view() const {
    return DevicePointView::row_major(data_.data(), n_, d_, stream_.get());
  }
  std::vector<double> rows() const {
    std::vector<float> single(n_ * d_);
    cuda::download(single.data(), data_.data(), single.size(), stream_.get());
    return {single.begin(), single.end()};
  }

 private:
  cuda::Stream stream_;
  unsigned d_;
  std::uint64_t n_;
  cuda::DeviceArray<float> data_;
};

template <class Work>
std::vector<double> timed(unsigned repeat, const Work& work) {
  std::vector<double> times;
  for (unsigned k = 0; k <= repeat; ++k) {
    const auto start = std::chrono::steady_clock::now();
    work();
    const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
    if (k > 0) times.push_back(took.count());
  }
  return times;
}

std::uint64_t scaled(std::uint64_t count, double scale) {
  return std::max<std::uint64_t>(
      1000, static_cast<std::uint64_t>(std::llround(static_cast<double>(count) * scale)));
}

ordered_json row(const char* name, std::uint64_t n, unsigned d, const std::vector<double>& times) {
  ordered_json json;
  json["workload"] = name;
  json["count"] = n;
  json["dimension"] = d;
  json["seconds"] = cullhull::bench::median(times);
  json["seconds_all"] = times;
  json["points_per_second"] = static_cast<double>(n) / cullhull::bench::median(times);
  return json;
}

/// The gauge map's pass over the points, without building the map.
ordered_json gauge_pass(const Settings& s, const char* name, std::uint64_t n, unsigned d,
                        const DevicePointView& view, const cullhull::internal::Run& run,
                        double copy_rate) {
  cullhull::internal::SampledPoints sample;
  sample.count = n;
  sample.dimension = d;
  sample.gather = [&](const std::vector<std::uint64_t>& ids) {
    return cuda::download_points(view, ids.data(), ids.size(), run.control);
  };
  const auto sampled = cullhull::internal::map_of_sample(
      sample, cullhull::internal::Insist::yes, cuda::most_gauge_nodes(cuda::device()), run);
  if (sampled.map == nullptr)
    throw cullhull::Error(cullhull::ErrorCode::invalid_argument, "no map: " + sampled.reason);
  std::uint64_t kept = n;
  ordered_json json = row(name, n, d, timed(s.repeat, [&] {
                            kept =
                                cuda::survivors_of_device_points(sampled.map->table(), view).count;
                          }));
  json["filter"] = "gauge, its pass alone";
  json["kept"] = static_cast<double>(kept) / static_cast<double>(n);
  json["share_of_copy"] = json["points_per_second"].get<double>() * d * sizeof(float) / copy_rate;
  std::printf("%-18s gauge, pass  %9.3f ms %8.2f G points/s  kept %7.4f %%, %.1f %% of copy\n",
              name, json["seconds"].get<double>() * 1e3,
              json["points_per_second"].get<double>() / 1e9, 100 * json["kept"].get<double>(),
              100 * json["share_of_copy"].get<double>());
  return json;
}

/// Both filters. For the gauge map also the rate at which it reads, 12 bytes per point, as a share
/// of the copy bandwidth.
ordered_json filters(const Settings& s, double copy_rate) {
  ordered_json rows = ordered_json::array();
  struct Case {
    const char* name;
    unsigned d;
    std::uint64_t count;
  };
  for (const Case c : {Case{"ball-3d-8M", 3, 8'000'000}, Case{"ball-3d-100M", 3, 100'000'000},
                       Case{"ball-4d-8M", 4, 8'000'000}}) {
    const std::uint64_t n = scaled(c.count, s.scale);
    const Points points(Shape::ball, c.d, n);
    cullhull::Options options;
    options.backend = cullhull::Backend::cuda;
    options.cull = cullhull::CullMethod::gauge;
    cullhull::Survivors survivors;
    ordered_json gauge =
        row(c.name, n, c.d,
            timed(s.repeat, [&] { survivors = cullhull::cull(points.view(), options); }));
    gauge["filter"] = cullhull::filter_name(survivors.filter);
    gauge["kept"] = static_cast<double>(survivors.size(n)) / static_cast<double>(n);
    gauge["share_of_copy"] =
        gauge["points_per_second"].get<double>() * c.d * sizeof(float) / copy_rate;
    std::printf("%-18s gauge        %9.3f ms %8.2f G points/s  kept %7.4f %%, %.1f %% of copy\n",
                c.name, gauge["seconds"].get<double>() * 1e3,
                gauge["points_per_second"].get<double>() / 1e9, 100 * gauge["kept"].get<double>(),
                100 * gauge["share_of_copy"].get<double>());
    rows.push_back(gauge);

    const cullhull::Options defaults;
    const cullhull::internal::Run run(defaults);
    rows.push_back(gauge_pass(s, c.name, n, c.d, points.view(), run, copy_rate));
    std::vector<std::uint64_t> kept;
    std::vector<cullhull::internal::PseudoHullRound> rounds;
    ordered_json pseudo = row(c.name, n, c.d, timed(s.repeat, [&] {
                                kept = cullhull::internal::pseudo_hull_survivors_cuda(
                                    points.view(), {}, run.control, &rounds);
                              }));
    pseudo["filter"] = "pseudo-hull";
    pseudo["kept"] = static_cast<double>(kept.size()) / static_cast<double>(n);
    pseudo["rounds"] = rounds.size();
    std::printf("%-18s pseudo-hull  %9.3f ms %8.2f G points/s  kept %7.4f %%, %zu rounds\n", c.name,
                pseudo["seconds"].get<double>() * 1e3,
                pseudo["points_per_second"].get<double>() / 1e9, 100 * pseudo["kept"].get<double>(),
                rounds.size());
    rows.push_back(pseudo);
    std::fflush(stdout);
  }
  return rows;
}

/// From points on the device to the exact hull, compared with Qhull; both must find the same hull.
ordered_json hulls(const Settings& s, bool& agreed) {
  ordered_json rows = ordered_json::array();
  for (const Workload& w : end_to_end) {
    const std::uint64_t n = scaled(w.count, s.scale);
    const Points points(w.shape, w.dimension, n);
    cullhull::Options options;
    options.backend = cullhull::Backend::cuda;
    cullhull::Hull hull;
    ordered_json json =
        row(w.name, n, w.dimension,
            timed(s.repeat, [&] { hull = cullhull::convex_hull(points.view(), options); }));
    json["vertices"] = hull.vertices.size();
    json["facets"] = hull.facet_count();
    json["survivors"] = hull.statistics.survivors;
    const double ours = json["seconds"].get<double>();
    std::printf("%-18s hull         %9.3f ms  %zu vertices", w.name, ours * 1e3,
                hull.vertices.size());
    std::fflush(stdout);
    if (s.qhull) {
      const std::vector<double> host = points.rows();
      const auto rival = cullhull::bench::run_qhull(
          cullhull::PointView::row_major(host.data(), n, w.dimension), {});
      if (rival) {
        const bool same = rival->vertices == hull.vertices.size() &&
                          std::fabs(rival->volume / hull.volume - 1) < 1e-9;
        agreed = agreed && same;
        json["qhull"] = {{"seconds", rival->seconds},
                         {"vertices", rival->vertices},
                         {"volume_ratio", rival->volume / hull.volume},
                         {"agrees", same}};
        json["times_faster"] = rival->seconds / ours;
        std::printf("; Qhull %9.1f ms, %.0f times, %s", rival->seconds * 1e3, rival->seconds / ours,
                    same ? "same hull" : "NOT THE SAME HULL");
      } else {
        std::printf("; no Qhull here");
      }
    }
    std::printf("\n");
    std::fflush(stdout);
    rows.push_back(json);
  }
  return rows;
}

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
    } else if (a == "--json") {
      s.json = value();
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
  ordered_json json;
  json["version"] = CULLHULL_VERSION;
  json["suite"] = "gpu";
  for (int i = 0; i < argc; ++i) json["command"].push_back(argv[i]);
  const auto machine = cullhull::bench::measure_machine({}, {}, {});
  json["machine"] = ordered_json::parse(cullhull::bench::machine_json(machine));
  std::printf("%s", cullhull::bench::machine_table(machine).c_str());
  json["device"] = {{"name", status.device},
                    {"compute_capability", status.compute_capability},
                    {"driver", status.driver_version},
                    {"runtime", status.runtime_version}};
  json["filters"] = filters(settings, machine.device ? machine.device->copy : 1);
  bool agreed = true;
  json["hulls"] = hulls(settings, agreed);
  if (!settings.json.empty()) cullhull::write_text(settings.json, json.dump(2) + '\n');
  return agreed ? 0 : 3;
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
