// How the work scales with the processor's threads, measured or predicted.
//
//     scaling_bench [--threads 1,2,4,8,16] [--only TEXT] [--repeat K] [--scale S] [--seconds T]
//                   [--out FILE] [--predict 1,2,4,8,16,64]
//
// Prints one line of JSON for each workload and number of threads as soon as it is measured, and
// appends it to FILE. "seconds" is the median of K calls; one call before them is not counted, if
// it takes less than a second. "ratio" is the time with the first number of threads over this one.
// Numbers of threads beyond the processor's, and parts that would start after T seconds, are left
// out with the reason. Every result must be that of the first number of threads. Exit status 1: one
// was not. --only: workloads whose name contains TEXT.
//
// --predict, in a build with CULLHULL_SPAN_ACCOUNT, tells what more threads than there are would
// take (src/parallel/threads/span_account.hpp): "one_thread" is the processor time of a call on one
// thread, "predicted" that of the call with so many workers, "serial" what of it lies outside of
// loops, "work" all that the workers do, over one_thread; "measured" is there if the processor has
// so many threads. Below the line stand the ten stretches with the longest spans: milliseconds of
// the span, of their work and of the longest chunk, calls, chunks, and where.
#include <algorithm>
#include <atomic>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <functional>
#include <memory>
#include <span>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "cullhull/batch.hpp"
#include "cullhull/certify.hpp"
#include "cullhull/cullhull.hpp"
#include "cullhull/generate.hpp"
#include "cullhull/stream.hpp"
#include "cullhull/track.hpp"
#include "cullhull/triangulation.hpp"
#include "cullhull/voronoi.hpp"
#include "json_lines.hpp"
#include "parallel/threads/parallel.hpp"
#include "timing.hpp"

namespace cullhull {
namespace {

using nlohmann::ordered_json;

struct Settings {
  std::vector<unsigned> threads{1, 2, 4, 8, 16};
  bool predict = false;
  unsigned repeat = 3;
  double scale = 1, seconds = 300;
  std::string out, only;
};

/// What tells whether two results are the same.
struct Fingerprint {
  std::uint64_t count = 0, vertices = 0;
  double measure = 0;
  bool operator==(const Fingerprint&) const = default;
};

Fingerprint of(const Hull& hull) { return {hull.facet_count(), hull.vertices.size(), hull.volume}; }

Options cpu_options(unsigned threads) {
  Options options;
  options.backend = Backend::cpu;
  options.threads = threads;
  return options;
}

/// A call that is measured, with any number of threads, over points that it keeps.
using Call = std::function<Fingerprint(unsigned threads)>;
using Rows = std::shared_ptr<const std::vector<double>>;

Rows rows_of(const char* shape, std::uint64_t count, unsigned dimension) {
  return std::make_shared<std::vector<double>>(generate(shape, count, dimension));
}

Call hull_call(const char* shape, std::uint64_t count, unsigned dimension) {
  return [rows = rows_of(shape, count, dimension), dimension](unsigned threads) {
    return of(convex_hull(PointView::row_major(*rows, dimension), cpu_options(threads)));
  };
}

Triangulation triangulate(const PointView& points, unsigned threads) {
  TriangulationOptions options;
  options.threads = threads;
  return delaunay(points, options);
}

Call delaunay_call(const char* shape, std::uint64_t count, unsigned dimension) {
  return [rows = rows_of(shape, count, dimension), dimension](unsigned threads) -> Fingerprint {
    const Triangulation t = triangulate(PointView::row_major(*rows, dimension), threads);
    std::uint64_t sum = 0;
    return {t.cells.size(), t.cells.size() > 0 ? t.cells.back() + sum : 0, 0};
  };
}

Call voronoi_call(const char* shape, std::uint64_t count, unsigned dimension) {
  const Rows rows = rows_of(shape, count, dimension);
  const auto cells =
      std::make_shared<const Triangulation>(triangulate(PointView::row_major(*rows, dimension), 0));
  return [rows, cells, dimension](unsigned threads) -> Fingerprint {
    RunOptions options;
    options.threads = threads;
    const Voronoi v = voronoi(PointView::row_major(*rows, dimension), *cells, {}, options);
    return {v.ridges.size(), v.regions.size(), 0};
  };
}

/// Sets of 64 points each.
Call batch_call(const char* shape, std::uint64_t sets, unsigned dimension) {
  constexpr std::uint64_t each = 64;
  std::vector<std::uint64_t> offsets;
  for (std::uint64_t i = 0; i <= sets; ++i) offsets.push_back(i * each);
  return [rows = rows_of(shape, sets * each, dimension), offsets = std::move(offsets),
          dimension](unsigned threads) -> Fingerprint {
    const HullBatch batch =
        convex_hulls(PointView::row_major(*rows, dimension), offsets, cpu_options(threads));
    return {batch.vertices.items.size(), batch.simplices.items.size(), 0};
  };
}

/// The second and later frames of a motion, by turns with the first.
Call track_call(const char* shape, std::uint64_t count, unsigned dimension) {
  const MovingPoints moving(shape, "twist", count, dimension, 30);
  std::vector<Rows> frames;
  for (unsigned f = 0; f < 4; ++f) {
    std::vector<double> frame(count * dimension);
    moving.frame(f, frame.data());
    frames.push_back(std::make_shared<std::vector<double>>(std::move(frame)));
  }
  struct State {
    unsigned threads = 0, frame = 0;
    std::unique_ptr<HullTracker> tracker;
  };
  return [frames, dimension, state = std::make_shared<State>()](unsigned threads) {
    if (state->tracker == nullptr || state->threads != threads) {
      *state = {threads, 0, std::make_unique<HullTracker>(cpu_options(threads))};
      state->tracker->update(PointView::row_major(*frames[3], dimension));
    }
    Fingerprint all;
    for (const Rows& frame : frames) {
      const Fingerprint f = of(state->tracker->update(PointView::row_major(*frame, dimension)));
      all = {all.count + f.count, all.vertices + f.vertices, all.measure + f.measure};
    }
    return all;
  };
}

Call certify_call(const char* shape, std::uint64_t count, unsigned dimension) {
  const Rows rows = rows_of(shape, count, dimension);
  const auto hull = std::make_shared<const Hull>(
      convex_hull(PointView::row_major(*rows, dimension), cpu_options(0)));
  return [rows, hull, dimension](unsigned threads) -> Fingerprint {
    const Certificate c =
        certify(PointView::row_major(*rows, dimension), *hull, cpu_options(threads));
    return {c.valid ? 1U : 0U, 0, 0};
  };
}

/// Threads that push blocks of one set, each its own.
Call stream_call(const char* shape, std::uint64_t count, unsigned dimension) {
  return [rows = rows_of(shape, count, dimension), dimension](unsigned threads) {
    constexpr std::uint64_t block = std::uint64_t{1} << 16;
    const auto points = PointView::row_major(*rows, dimension);
    HullStream stream(cpu_options(threads));
    const auto push = [&](std::uint64_t first) {
      PointView part = points;
      part.data = points.address(first, 0);
      part.count = std::min(block, points.count - first);
      stream.push(part, first);
    };
    if (internal::counting_spans()) {
      internal::for_each_chunk(
          points.count, block, threads,
          [&](std::uint64_t, std::uint64_t first, std::uint64_t) { push(first); });
    } else {
      std::atomic<std::uint64_t> next{0};
      std::vector<std::exception_ptr> failures(threads);
      std::vector<std::jthread> pushing;
      for (unsigned t = 0; t < threads; ++t)
        pushing.emplace_back([&, t] {
          try {
            for (std::uint64_t first; (first = next.fetch_add(block)) < points.count;) push(first);
          } catch (...) {
            failures[t] = std::current_exception();
          }
        });
      pushing.clear();
      for (const std::exception_ptr& failure : failures)
        if (failure) std::rethrow_exception(failure);
    }
    return of(stream.hull());
  };
}

struct Workload {
  const char* name;
  Call (*make)(const char* shape, std::uint64_t count, unsigned dimension);
  const char* shape;
  unsigned dimension;
  double count;
};

// A run can be cut off: what was measured on other machines comes first, and of that what takes
// least.
constexpr Workload workloads[] = {
    {"hull, 3D ball", hull_call, "ball", 3, 8e6},
    {"stream, 3D ball", stream_call, "ball", 3, 8e6},
    {"hull, 3D sphere surface", hull_call, "sphere", 3, 1e6},
    {"hull, 4D ball", hull_call, "ball", 4, 8e6},
    {"triangulation, 3D ball", delaunay_call, "ball", 3, 1e6},
    {"hull, 3D octahedron", hull_call, "octahedron", 3, 1e7},
    {"hull, 3D cube", hull_call, "cube", 3, 1e7},
    {"hull, 3D gauss", hull_call, "gauss", 3, 1e7},
    {"hull, 3D cylinder", hull_call, "cylinder", 3, 1e7},
    {"hull, 2D disk", hull_call, "ball", 2, 1e7},
    {"hull, 2D circle", hull_call, "sphere", 2, 2e6},
    {"hull, 3D grid 128^3", hull_call, "grid", 3, 2e6},
    {"hull, 3D cone", hull_call, "cone", 3, 1e6},
    {"hull, 4D ball of 2M", hull_call, "ball", 4, 2e6},
    {"hull, 4D gauss", hull_call, "gauss", 4, 1e6},
    {"hull, 4D sphere surface", hull_call, "sphere", 4, 1e5},
    {"hull, 5D ball", hull_call, "ball", 5, 1e6},
    {"hull, 5D sphere surface", hull_call, "sphere", 5, 1e4},
    {"hull, 6D ball", hull_call, "ball", 6, 1e5},
    {"triangulation, 3D ball of 300k", delaunay_call, "ball", 3, 3e5},
    {"triangulation, 2D disk", delaunay_call, "ball", 2, 1e6},
    {"Voronoi diagram, 3D ball", voronoi_call, "ball", 3, 1e6},
    {"batch of sets of 64, 3D ball", batch_call, "ball", 3, 1e5},
    {"four tracked frames, bumpy", track_call, "bumpy", 3, 1.1e6},
    {"certificate, 3D sphere surface", certify_call, "sphere", 3, 1e6},
};

class Scaling {
 public:
  explicit Scaling(const Settings& settings)
      : settings_(settings), lines_(settings.out, settings.seconds) {}

  int run() {
    for (const Workload& w : workloads) {
      if (std::string(w.name).find(settings_.only) == std::string::npos) continue;
      const auto count =
          std::max<std::uint64_t>(1000, static_cast<std::uint64_t>(w.count * settings_.scale));
      Call call;
      if (lines_.seconds_left() > 0) call = w.make(w.shape, count, w.dimension);
      measured_ = false;
      for (const unsigned threads : settings_.threads) {
        stretches_.clear();
        lines_.part({{"workload", w.name}, {"count", count}, {"threads", threads}}, [&] {
          return settings_.predict ? predict(call, threads) : measure(call, threads);
        });
        std::fputs(stretches_.c_str(), stdout);
      }
    }
    return lines_.failed() ? 1 : 0;
  }

 private:
  static unsigned cores() { return internal::resolve_threads(0); }

  void hold(const Fingerprint& found, double seconds) {
    if (!measured_) {
      measured_ = true;
      expected_ = found;
      first_seconds_ = seconds;
    }
    if (found != expected_) throw std::runtime_error("the result depends on the threads");
  }

  std::vector<double> times_of(const Call& call, unsigned threads, Fingerprint& found) const {
    const auto one = [&] { found = call(threads); };
    std::vector<double> times{bench::seconds_of(one)};
    if (times[0] < 1) times.clear();
    while (times.size() < settings_.repeat) times.push_back(bench::seconds_of(one));
    return times;
  }

  ordered_json measure(const Call& call, unsigned threads) {
    const unsigned cores = Scaling::cores();
    if (threads > cores && measured_)
      return {{"left_out", "this processor runs " + std::to_string(cores) + " threads"}};
    Fingerprint found;
    const std::vector<double> times = times_of(call, threads, found);
    const double seconds = bench::median(times);
    hold(found, seconds);
    return {{"seconds", seconds},
            {"seconds_all", times},
            {"ratio", first_seconds_ / seconds},
            {"processor_threads", cores}};
  }

#ifdef CULLHULL_SPAN_ACCOUNT
  /// The account of the call with the median prediction; the first number of threads is one.
  ordered_json predict(const Call& call, unsigned threads) {
    using internal::SpanAccount;
    using internal::SpanStretch;
    Fingerprint found;
    std::vector<SpanAccount> accounts;
    found = call(threads);
    while (accounts.size() < settings_.repeat)
      accounts.push_back(internal::account_of_spans(threads, [&] { found = call(threads); }));
    std::sort(accounts.begin(), accounts.end(),
              [](const auto& a, const auto& b) { return a.predicted < b.predicted; });
    const SpanAccount& account = accounts[accounts.size() / 2];
    hold(found, account.predicted);
    ordered_json line{{"one_thread", first_seconds_},
                      {"predicted", account.predicted},
                      {"ratio", first_seconds_ / account.predicted},
                      {"serial", account.serial},
                      {"work", account.work / first_seconds_}};
    if (threads <= cores()) {
      line["measured"] = bench::median(times_of(call, threads, found));
      hold(found, 0);
    }
    const std::size_t shown = std::min<std::size_t>(10, account.stretches.size());
    for (const SpanStretch& s : std::span(account.stretches).first(shown)) {
      char text[96];
      std::snprintf(text, sizeof text, "  %9.3f %9.3f %8.3f %6llu %8llu  ", 1e3 * s.span,
                    1e3 * s.work, 1e3 * s.longest, static_cast<unsigned long long>(s.calls),
                    static_cast<unsigned long long>(s.chunks));
      stretches_ += text + s.name + '\n';
    }
    return line;
  }
#else
  ordered_json predict(const Call&, unsigned) {
    throw std::runtime_error("--predict needs a build with -DCULLHULL_SPAN_ACCOUNT=ON");
  }
#endif

  const Settings& settings_;
  bench::JsonLines lines_;
  bool measured_ = false;
  Fingerprint expected_;
  double first_seconds_ = 0;
  std::string stretches_;
};

[[noreturn]] void bad_usage(const std::string& what) {
  std::fprintf(
      stderr,
      "scaling_bench: %s\nusage: scaling_bench [--threads 1,2,4] [--only TEXT] [--repeat K] "
      "[--scale S] [--seconds T] [--out FILE] [--predict 1,2,16]\n",
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
    } else if (a == "--only") {
      s.only = value;
    } else if (a == "--threads" || a == "--predict") {
      s.predict = a == "--predict";
      s.threads.clear();
      for (char* at = argv[i]; *at != 0; at += *at == ',') {
        char* const before = at;
        s.threads.push_back(static_cast<unsigned>(std::strtoul(at, &at, 10)));
        if (at == before || s.threads.back() == 0) bad_usage(a + " needs numbers: 1,2,4");
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
