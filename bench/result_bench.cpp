// The stages after the engine: runs an engine once (in 3D once per repeat), build_hull many times,
// and certify once.
//
//   bench/result_bench [repeats] [shape dimension count]...
//
// Shapes: those of generate(). Prints the best time of build_hull in ms with one and two threads,
// the least CPU time in ms, the time by phase for the best run, nanoseconds per facet, bytes of the
// result per facet and a hash of it.
#include <sys/resource.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include "agreement/canonical_hash.hpp"
#include "cullhull/certify.hpp"
#include "cullhull/generate.hpp"
#include "cullhull/options.hpp"
#include "geometry/local_frame.hpp"
#include "hull/engine.hpp"
#include "parallel/threads/parallel.hpp"
#include "result/build_hull.hpp"

namespace {

using namespace cullhull;
using namespace cullhull::internal;
using Clock = std::chrono::steady_clock;

double milliseconds(Clock::time_point from, Clock::time_point to) {
  return std::chrono::duration<double, std::milli>(to - from).count();
}

/// CPU time of all threads, in user and kernel mode, in ms.
std::pair<double, double> cpu() {
  rusage r{};
  getrusage(RUSAGE_SELF, &r);
  const auto ms = [](const timeval& t) {
    return 1e3 * static_cast<double>(t.tv_sec) + 1e-3 * static_cast<double>(t.tv_usec);
  };
  return {ms(r.ru_utime), ms(r.ru_stime)};
}

/// Bytes of the lists of a hull whose facets are simplices.
std::uint64_t bytes(const Hull& h) {
  const std::uint64_t items = h.facets.items.shares(h.simplices) ? 0 : h.facets.items.size();
  return 8 * (items + h.facet_planes.size() + h.simplices.size()) +
         4 * (h.facet_neighbours.items.size() + h.simplex_neighbours.size());
}

void run(const char* shape, unsigned d, std::uint64_t n, unsigned repeats) {
  const std::vector<double> rows = generate(shape, n, d);
  const PointView view = PointView::row_major(rows.data(), n, d);
  Options options;
  std::vector<std::pair<std::string, Clock::time_point>> marks;
  options.progress = [&](const char* phase, double) { marks.emplace_back(phase, Clock::now()); };
  const Run run(options);
  const LocalFrame frame(Array<double>(rows.begin(), rows.end()), static_cast<std::uint32_t>(n), d,
                         run.with_threads(2));
  const auto start = Clock::now();
  const LocalPoints& local = frame.points();
  const std::uint64_t budget = ~std::uint64_t{0};
  const Boundary boundary =
      d == 2   ? hull_2d(local, run.with_threads(1))
      : d == 3 ? hull_3d(local, frame.simplex().data(), run.with_budget(budget).with_threads(1))
               : hull_nd(local, frame.simplex().data(), run.with_budget(budget).with_threads(1));
  const std::size_t facets = boundary.facet_count();
  std::printf("%s %uD %llu points, %zu facets; engine %.1f ms\n", shape, d,
              static_cast<unsigned long long>(n), facets, milliseconds(start, Clock::now()));
  for (const unsigned threads : {1U, 2U}) {
    double best = 1e300, user = 1e300, system = 1e300;
    std::string phases;
    Hull last;
    for (unsigned r = 0; r < repeats; ++r) {
      // Building the 3D result consumes the engine's facets, which cannot be copied.
      Boundary copy;
      TriangleMesh surface;
      if (d == 3)
        surface = triangle_mesh(local, frame.simplex().data(),
                                run.with_budget(budget).with_threads(threads));
      else
        copy = boundary;
      Hull hull;
      marks.clear();
      const auto cpu_begin = cpu();
      const auto begin = Clock::now();
      const ResultInput input{&view, &local, nullptr, frame.axes().data()};
      if (d == 3)
        build_hull(input, std::move(surface), run.with_threads(threads), hull);
      else
        build_hull(input, std::move(copy), run.with_threads(threads), hull);
      const auto end = Clock::now();
      const auto cpu_end = cpu();
      user = std::min(user, cpu_end.first - cpu_begin.first);
      system = std::min(system, cpu_end.second - cpu_begin.second);
      if (milliseconds(begin, end) < best) {
        best = milliseconds(begin, end);
        phases.clear();
        marks.emplace_back("", end);
        for (std::size_t i = 0; i + 1 < marks.size(); ++i) {
          char text[64];
          std::snprintf(text, sizeof text, " %s %.1f", marks[i].first.c_str(),
                        milliseconds(marks[i].second, marks[i + 1].second));
          phases += text;
        }
      }
      last = std::move(hull);
    }
    std::printf(
        "  threads %u: %.2f ms, CPU %.1f + %.1f system, %.1f ns and %.0f bytes a facet, "
        "hash %016llx;%s\n",
        threads, best, user, system, 1e6 * best / static_cast<double>(facets),
        static_cast<double>(bytes(last)) / static_cast<double>(facets),
        static_cast<unsigned long long>(testing_support::canonical_hash(last)), phases.c_str());
    if (std::getenv("CERTIFY") == nullptr) continue;
    options.threads = threads;
    const auto begin = Clock::now();
    marks.clear();
    const Certificate c = certify(view, last, options);
    std::printf("    certify %.1f ms: %s;", milliseconds(begin, Clock::now()),
                c.valid ? "valid" : c.reason.c_str());
    for (std::size_t i = 0; i + 1 < marks.size(); ++i)
      std::printf(" %.1f", milliseconds(marks[i].second, marks[i + 1].second));
    std::printf("\n");
  }
}

}  // namespace

int main(int argc, char** argv) {
  const unsigned repeats = argc > 1 ? static_cast<unsigned>(std::atoi(argv[1])) : 5;
  if (argc < 5) {
    run("sphere", 3, 1'000'000, repeats);
    run("sphere", 2, 1'000'000, repeats);
    run("ball", 4, 1'000'000, repeats);
    return 0;
  }
  for (int i = 2; i + 2 < argc; i += 3)
    run(argv[i], static_cast<unsigned>(std::atoi(argv[i + 1])),
        static_cast<std::uint64_t>(std::atoll(argv[i + 2])), repeats);
}
