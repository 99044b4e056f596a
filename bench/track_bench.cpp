// Moving points, frame by frame: the tracker, convex_hull for each frame, and Qhull on the same
// frames in one run: track_bench [--threads N] [--qhull-every K] [--repeat R] SEQUENCE.npy...
//
// Each frame is in memory with warm pages before it is timed. Cullhull's times end with the
// complete result; Qhull (option Qt, as SciPy calls it) is timed for its hull alone, on every K-th
// frame. Each time is the least of R runs; means over the frames are printed. A ratio above 1 means
// that cullhull is faster.
#include <libqhull_r/qhull_ra.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include "cullhull/cullhull.hpp"
#include "cullhull/io.hpp"

namespace {

struct Settings {
  unsigned threads = 0;
  std::uint64_t qhull_every = 1;
  int repeat = 1;
  bool frames = false;
  cullhull::CullMethod cull = cullhull::CullMethod::automatic;
  std::vector<std::string> paths;
};

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

double qhull_seconds(const std::vector<double>& rows, unsigned d, std::uint64_t& vertices) {
  qhT q;
  std::FILE* nowhere = std::fopen("/dev/null", "w");
  qh_zero(&q, nowhere);
  char command[] = "qhull Qt";
  const auto start = std::chrono::steady_clock::now();
  const int code = qh_new_qhull(&q, static_cast<int>(d), static_cast<int>(rows.size() / d),
                                const_cast<double*>(rows.data()), 0, command, nowhere, nowhere);
  const double seconds = seconds_since(start);
  vertices = code == 0 ? static_cast<std::uint64_t>(q.num_vertices) : 0;
  qh_freeqhull(&q, !qh_ALL);
  int short_memory = 0, long_memory = 0;
  qh_memfreeshort(&q, &short_memory, &long_memory);
  std::fclose(nowhere);
  return seconds;
}

void run(const std::string& path, const Settings& s) {
  cullhull::PointSequence sequence = cullhull::open_sequence({path});
  cullhull::Options options;
  options.threads = s.threads;
  cullhull::Options tracked = options;
  tracked.cull = s.cull;
  std::vector<cullhull::HullTracker> trackers;
  for (int r = 0; r < s.repeat; ++r) trackers.emplace_back(tracked);
  std::vector<double> rows;
  double ours = 0, first = 0, fixed = 0, qhull = 0, scan_share = 0, share = 0;
  double cull = 0, scan = 0;
  std::uint64_t frames = 0, rival_frames = 0, differ = 0, led = 0;
  std::vector<double> fixed_on_rival;
  double ours_on_rival = 0;
  while (sequence.next()) {
    const cullhull::PointView& seen = sequence.points();
    rows.resize(seen.count * seen.dimension);
    for (std::uint64_t i = 0; i < seen.count; ++i)
      for (unsigned j = 0; j < seen.dimension; ++j) rows[i * seen.dimension + j] = seen.at(i, j);
    const auto points = cullhull::PointView::row_major(rows.data(), seen.count, seen.dimension);
    double best = 1e300, best_fixed = 1e300;
    cullhull::Hull reference;
    for (int r = 0; r < s.repeat; ++r) {
      auto start = std::chrono::steady_clock::now();
      reference = cullhull::convex_hull(points, options);
      best_fixed = std::min(best_fixed, seconds_since(start));
      start = std::chrono::steady_clock::now();
      trackers[static_cast<std::size_t>(r)].update(points);
      best = std::min(best, seconds_since(start));
    }
    const cullhull::FrameReport& report = trackers[0].report();
    const cullhull::Hull& hull = trackers[0].hull();
    if (hull.simplices != reference.simplices || hull.volume != reference.volume) ++differ;
    const auto n = static_cast<double>(points.count);
    if (report.index == 0)
      first = best;
    else {
      ++led;
      scan_share += static_cast<double>(report.scan_survivors) / n;
      share += static_cast<double>(report.survivors) / n;
      cull += report.cull_seconds;
      scan += report.scan_seconds;
    }
    ours += best;
    fixed += best_fixed;
    double rival = 0;
    std::uint64_t rival_vertices = 0;
    if (s.qhull_every > 0 && frames % s.qhull_every == s.qhull_every / 2) {
      rival = qhull_seconds(rows, points.dimension, rival_vertices);
      qhull += rival;
      ours_on_rival += best;
      ++rival_frames;
    }
    if (s.frames)
      std::printf(
          "  %4llu %-11s %8.3f ms (scan %.3f cull %.3f hull %.3f)  static %8.3f  Qhull %9.2f  "
          "scan %6.2f %%  left %6.3f %%  vertices %zu +%llu -%llu%s\n",
          static_cast<unsigned long long>(report.index), report.method, best * 1e3,
          report.scan_seconds * 1e3, report.cull_seconds * 1e3, report.hull_seconds * 1e3,
          best_fixed * 1e3, rival * 1e3, 100 * static_cast<double>(report.scan_survivors) / n,
          100 * static_cast<double>(report.survivors) / n, hull.vertices.size(),
          static_cast<unsigned long long>(report.vertices_came),
          static_cast<unsigned long long>(report.vertices_went),
          rival > 0 && rival_vertices != hull.vertices.size() ? "  Qhull differs" : "");
    ++frames;
  }
  const auto mean = [](double sum, std::uint64_t k) {
    return k > 0 ? sum / static_cast<double>(k) : 0;
  };
  std::printf("%s: %llu frames, mean ms: ours %.3f (first %.2f), static %.3f (%.2fx)", path.c_str(),
              static_cast<unsigned long long>(frames), 1e3 * mean(ours, frames), 1e3 * first,
              1e3 * mean(fixed, frames), fixed / ours);
  if (rival_frames > 0)
    std::printf(", Qhull %.1f on %llu frames (%.1fx)", 1e3 * mean(qhull, rival_frames),
                static_cast<unsigned long long>(rival_frames), qhull / ours_on_rival);
  std::printf(
      "; scan %.3f ms keeps %.2f %%, cull %.3f ms keeps %.2f %%; %llu frames differ from static\n",
      1e3 * mean(scan, led), 100 * mean(scan_share, led), 1e3 * mean(cull, led),
      100 * mean(share, led), static_cast<unsigned long long>(differ));
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  Settings s;
  for (int i = 1; i < argc; ++i) {
    const std::string a = argv[i];
    const auto value = [&]() -> const char* {
      if (i + 1 == argc) {
        std::fprintf(stderr, "track_bench: %s needs a value\n", a.c_str());
        std::exit(2);
      }
      return argv[++i];
    };
    if (a == "--threads") {
      s.threads = static_cast<unsigned>(std::atoi(value()));
    } else if (a == "--qhull-every") {
      s.qhull_every = static_cast<std::uint64_t>(std::max(0, std::atoi(value())));
    } else if (a == "--repeat") {
      s.repeat = std::max(1, std::atoi(value()));
    } else if (a == "--frames") {
      s.frames = true;
    } else if (a == "--pseudo-hull") {
      s.cull = cullhull::CullMethod::pseudo_hull;
    } else if (a.rfind("--", 0) == 0) {
      std::fprintf(stderr, "track_bench: unknown option %s\n", a.c_str());
      return 2;
    } else {
      s.paths.push_back(a);
    }
  }
  try {
    for (const std::string& path : s.paths) run(path, s);
  } catch (const cullhull::Error& e) {
    std::fprintf(stderr, "track_bench: %s\n", e.what());
    return 1;
  }
}
