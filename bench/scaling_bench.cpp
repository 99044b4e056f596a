// How the work scales with the processor's threads: 3D ball and sphere, 4D ball, a triangulation of
// space, a stream.
//
//     scaling_bench [--threads 1,2,4,8,16] [--repeat K] [--scale S] [--seconds T] [--out FILE]
//
// Prints one line of JSON for each workload and number of threads as soon as it is measured, and
// appends it to FILE. "seconds" is the median of K calls; one call before them is not counted, if
// it takes less than a second. "ratio" is the time with the first number of threads over this one.
// Numbers of threads beyond the processor's, and parts that would start after T seconds, are left
// out with the reason. Every result must be that of the first number of threads. Exit status 1: one
// was not.
#include <algorithm>
#include <atomic>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "cullhull/cullhull.hpp"
#include "cullhull/generate.hpp"
#include "cullhull/stream.hpp"
#include "cullhull/triangulation.hpp"
#include "json_lines.hpp"
#include "timing.hpp"

namespace cullhull {
namespace {

using nlohmann::ordered_json;

struct Settings {
  std::vector<unsigned> threads{1, 2, 4, 8, 16};
  unsigned repeat = 3;
  double scale = 1, seconds = 300;
  std::string out;
};

/// What tells whether two results are the same.
struct Fingerprint {
  std::uint64_t count = 0, vertices = 0;
  double measure = 0;
  bool operator==(const Fingerprint&) const = default;
};

Fingerprint of(const Hull& hull) { return {hull.facet_count(), hull.vertices.size(), hull.volume}; }

Fingerprint hull(const PointView& points, unsigned threads) {
  Options options;
  options.backend = Backend::cpu;
  options.threads = threads;
  return of(convex_hull(points, options));
}

Fingerprint triangulation(const PointView& points, unsigned threads) {
  TriangulationOptions options;
  options.threads = threads;
  const Triangulation t = delaunay(points, options);
  std::uint64_t sum = 0;
  for (const auto v : t.cells) sum = sum * 31 + v;
  return {t.cells.size(), sum, 0};
}

/// Threads that push blocks of one set, each its own.
Fingerprint stream(const PointView& points, unsigned threads) {
  constexpr std::uint64_t block = std::uint64_t{1} << 16;
  Options one;
  one.backend = Backend::cpu;
  one.threads = 1;
  HullStream stream(one);
  std::atomic<std::uint64_t> next{0};
  std::vector<std::exception_ptr> failures(threads);
  std::vector<std::jthread> pushing;
  for (unsigned t = 0; t < threads; ++t)
    pushing.emplace_back([&, t] {
      try {
        for (std::uint64_t first; (first = next.fetch_add(block)) < points.count;) {
          PointView part = points;
          part.data = points.address(first, 0);
          part.count = std::min(block, points.count - first);
          stream.push(part, first);
        }
      } catch (...) {
        failures[t] = std::current_exception();
      }
    });
  pushing.clear();
  for (const std::exception_ptr& failure : failures)
    if (failure) std::rethrow_exception(failure);
  Options all = one;
  all.threads = threads;
  return of(stream.state().hull(all));
}

struct Workload {
  const char* name;
  const char* shape;
  unsigned dimension;
  double count;
  Fingerprint (*work)(const PointView&, unsigned threads);
};

// Those that take least come first: a run can be cut off.
constexpr Workload workloads[] = {
    {"hull, 3D ball", "ball", 3, 8e6, hull},
    {"stream, 3D ball", "ball", 3, 8e6, stream},
    {"hull, 3D sphere surface", "sphere", 3, 1e6, hull},
    {"hull, 4D ball", "ball", 4, 8e6, hull},
    {"triangulation, 3D ball", "ball", 3, 1e6, triangulation},
};

class Scaling {
 public:
  explicit Scaling(const Settings& settings)
      : settings_(settings), lines_(settings.out, settings.seconds) {}

  int run() {
    for (const Workload& w : workloads) {
      const auto count =
          std::max<std::uint64_t>(1000, static_cast<std::uint64_t>(w.count * settings_.scale));
      std::vector<double> rows;
      if (lines_.seconds_left() > 0) rows = generate(w.shape, count, w.dimension);
      const auto points = PointView::row_major(rows.data(), rows.size() / w.dimension, w.dimension);
      measured_ = false;
      for (const unsigned threads : settings_.threads)
        lines_.part({{"workload", w.name}, {"count", count}, {"threads", threads}},
                    [&] { return measure(w, points, threads); });
    }
    return lines_.failed() ? 1 : 0;
  }

 private:
  ordered_json measure(const Workload& w, const PointView& points, unsigned threads) {
    const unsigned cores = std::thread::hardware_concurrency();
    if (threads > cores && measured_)
      return {{"left_out", "this processor runs " + std::to_string(cores) + " threads"}};
    Fingerprint found;
    const auto call = [&] { found = w.work(points, threads); };
    std::vector<double> times{bench::seconds_of(call)};
    if (times[0] < 1) times.clear();
    while (times.size() < settings_.repeat) times.push_back(bench::seconds_of(call));
    const double seconds = bench::median(times);
    if (!measured_) {
      measured_ = true;
      expected_ = found;
      first_seconds_ = seconds;
    }
    if (found != expected_) throw std::runtime_error("the result depends on the threads");
    return {{"seconds", seconds},
            {"seconds_all", times},
            {"ratio", first_seconds_ / seconds},
            {"processor_threads", cores}};
  }

  const Settings& settings_;
  bench::JsonLines lines_;
  bool measured_ = false;
  Fingerprint expected_;
  double first_seconds_ = 0;
};

[[noreturn]] void bad_usage(const std::string& what) {
  std::fprintf(stderr,
               "scaling_bench: %s\nusage: scaling_bench [--threads 1,2,4] [--repeat K] "
               "[--scale S] [--seconds T] [--out FILE]\n",
               what.c_str());
  std::exit(2);
}

Settings parse(int argc, char** argv) {
  Settings s;
  for (int i = 1; i < argc; ++i) {
    const std::string a = argv[i];
    if (i + 1 >= argc) bad_usage(a + " is unknown or needs a value");
    const char* value = argv[++i];
    if (a == "--out") {
      s.out = value;
    } else if (a == "--repeat") {
      s.repeat = static_cast<unsigned>(std::max(1, std::atoi(value)));
    } else if (a == "--scale") {
      s.scale = std::atof(value);
    } else if (a == "--seconds") {
      s.seconds = std::atof(value);
    } else if (a == "--threads") {
      s.threads.clear();
      for (char* at = argv[i]; *at != 0; at += *at == ',') {
        char* const before = at;
        s.threads.push_back(static_cast<unsigned>(std::strtoul(at, &at, 10)));
        if (at == before || s.threads.back() == 0) bad_usage("--threads needs numbers: 1,2,4");
      }
    } else {
      bad_usage("unknown option " + a);
    }
  }
  if (!(s.scale > 0) || s.threads.empty()) bad_usage("--scale must be positive");
  return s;
}

}  // namespace
}  // namespace cullhull

int main(int argc, char** argv) {
  try {
    const cullhull::Settings settings = cullhull::parse(argc, argv);
    return cullhull::Scaling(settings).run();
  } catch (const std::exception& e) {
    std::fprintf(stderr, "scaling_bench: %s\n", e.what());
    return 1;
  }
}
