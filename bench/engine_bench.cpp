// The 3D engine alone on the inputs that are hard for it: all points extreme, slivers, plateaus,
// lattices, thin bodies, duplicates.
//
//     engine_bench [--n N] [--threads 1,2] [--repeat K] [--certify] [WORKLOAD ...]
//
// Prints the least and the median time in ms, the least processor time, simplices, decisions of
// each rung. --certify runs the whole pipeline without the filter instead, certifies the result and
// prints a hash of it.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "cullhull/certify.hpp"
#include "cullhull/generate.hpp"
#include "cullhull/hull.hpp"
#include "hull/engine.hpp"
#include "points/local_frame.hpp"

namespace cullhull::internal {
namespace {

using Rows = std::vector<double>;

void turn(Rows& rows) {  // an orthogonal matrix but for rounding
  const double a = 0.7, b = 1.1;
  for (std::size_t i = 0; i + 2 < rows.size(); i += 3) {
    double* p = rows.data() + i;
    const double x = std::cos(a) * p[0] - std::sin(a) * p[1];
    const double y = std::sin(a) * p[0] + std::cos(a) * p[1];
    p[0] = x;
    p[1] = std::cos(b) * y - std::sin(b) * p[2];
    p[2] = std::sin(b) * y + std::cos(b) * p[2];
  }
}

Rows squashed(std::uint64_t n) {
  Rows rows = generate("sphere", n, 3);
  for (std::size_t i = 2; i < rows.size(); i += 3) rows[i] *= 1e-9;
  return rows;
}

/// The surface of a grid of the cube with about n points.
Rows lattice_surface(std::uint64_t n) {
  const auto k = static_cast<int>(std::sqrt(static_cast<double>(n) / 6));
  Rows rows;
  for (int x = 0; x <= k; ++x)
    for (int y = 0; y <= k; ++y)
      for (int z = 0; z <= k; z += (x == 0 || y == 0 || x == k || y == k) ? 1 : k)
        rows.insert(rows.end(), {double(x) / k - 0.5, double(y) / k - 0.5, double(z) / k - 0.5});
  return rows;
}

Rows two_circles(std::uint64_t n) {
  Rows rows = generate("sphere", n, 2, 7), out;
  for (std::size_t i = 0; i < n; ++i)
    out.insert(out.end(), {rows[2 * i], rows[2 * i + 1], i % 2 == 0 ? -1.0 : 1.0});
  return out;
}

Rows cospherical_integers() {
  Rows rows;
  constexpr int square = 5 * 5 * 13 * 13 * 17 * 17 * 29;
  for (int x = 0; x * x <= square; ++x)
    for (int y = 0; x * x + y * y <= square; ++y) {
      const int rest = square - x * x - y * y;
      const int z = static_cast<int>(std::lround(std::sqrt(rest)));
      if (z * z != rest) continue;
      for (int s = 0; s < 8; ++s)
        rows.insert(rows.end(),
                    {double(s & 1 ? -x : x), double(s & 2 ? -y : y), double(s & 4 ? -z : z)});
    }
  return rows;
}

Rows copies(Rows rows, unsigned times) {
  const std::size_t size = rows.size();
  for (unsigned k = 1; k < times; ++k)
    for (std::size_t i = 0; i < size; ++i) rows.push_back(rows[i]);
  return rows;
}

Rows turned(Rows rows) {
  turn(rows);
  return rows;
}

/// A plane turned in space: as thick as the rounding.
Rows thin_plane(std::uint64_t n) {
  Rows rows = generate("cube", n, 3, 3);
  for (std::size_t i = 2; i < rows.size(); i += 3) rows[i] = 0;
  turn(rows);
  return rows;
}

using Maker = std::function<Rows(std::uint64_t)>;
const std::map<std::string, Maker, std::less<>>& workloads() {
  static const std::map<std::string, Maker, std::less<>> table = {
      {"sphere", [](auto n) { return generate("sphere", n, 3); }},
      {"cylinder", [](auto n) { return generate("cylinder", n, 3); }},
      {"turned-cylinder", [](auto n) { return turned(generate("cylinder", n, 3)); }},
      {"cone", [](auto n) { return generate("cone", n, 3); }},
      {"lattice-surface", lattice_surface},
      {"turned-lattice-surface", [](auto n) { return turned(lattice_surface(n)); }},
      {"two-circles", two_circles},
      {"turned-two-circles", [](auto n) { return turned(two_circles(n)); }},
      {"squashed", squashed},
      {"turned-squashed", [](auto n) { return turned(squashed(n)); }},
      {"thin-plane", thin_plane},
      {"grid", [](auto n) { return generate("grid", n, 3); }},
      {"grid-wide", [](auto n) { return generate("grid:1048576", n, 3); }},
      {"cospherical", [](auto) { return cospherical_integers(); }},
      {"duplicates", [](auto n) { return copies(generate("sphere", n / 8, 3), 8); }},
      {"cube-surface", [](auto n) { return generate("cube-surface", n, 3); }},
      {"turned-cube-surface", [](auto n) { return turned(generate("cube-surface", n, 3)); }},
      {"ball", [](auto n) { return generate("ball", n, 3); }},
      {"gauss", [](auto n) { return generate("gauss", n, 3); }},
      {"bumpy", [](auto n) { return generate("bumpy", n, 3); }},
      {"cyclic", [](auto n) { return generate("cyclic", std::min<std::uint64_t>(n, 60000), 3); }},
  };
  return table;
}

double now() {
  return std::chrono::duration<double, std::milli>(
             std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

/// Of all threads: what a busy machine does not disturb as much.
double processor_ms() { return 1e3 * static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

void engine_alone(const std::string& name, const Rows& rows, unsigned threads, unsigned repeat) {
  const Options options;
  const Control control(options);
  const LocalFrame frame(cullhull::Array<double>(rows.begin(), rows.end()),
                         static_cast<std::uint32_t>(rows.size() / 3), 3, threads, control);
  std::vector<double> times, busy;
  SimplicialHull hull;
  for (unsigned k = 0; k < repeat; ++k) {
    hull = {};
    const double start = now(), busy_start = processor_ms();
    hull =
        hull_3d(frame.points(), frame.simplex().data(), std::uint64_t{8} << 30, threads, control);
    times.push_back(now() - start);
    busy.push_back(processor_ms() - busy_start);
  }
  std::sort(times.begin(), times.end());
  std::sort(busy.begin(), busy.end());
  std::printf(
      "%-22s %8zu points %u threads: %10.4f ms, median %10.4f, processor %10.4f; %zu simplices, "
      "rungs %llu %llu %llu\n",
      name.c_str(), rows.size() / 3, threads, times[0], times[times.size() / 2], busy[0],
      hull.facet_count(), static_cast<unsigned long long>(hull.rung_counts[0]),
      static_cast<unsigned long long>(hull.rung_counts[1]),
      static_cast<unsigned long long>(hull.rung_counts[2]));
  std::fflush(stdout);
}

void certified(const std::string& name, const Rows& rows, unsigned threads) {
  Options options;
  options.cull = CullMethod::none;
  options.threads = threads;
  const PointView view = PointView::row_major(rows.data(), rows.size() / 3, 3);
  const double start = now();
  const Hull hull = convex_hull(view, options);
  const double end = now();
  std::uint64_t hash = 0xcbf29ce484222325ULL;
  const auto add = [&](std::uint64_t v) { hash = (hash ^ v) * 0x100000001b3ULL; };
  for (const auto v : hull.vertices) add(v);
  for (const auto v : hull.simplices) add(v);
  const Certificate c = certify(view, hull, options);
  std::printf(
      "%-22s %8zu points %u threads: %9.1f ms, certify %9.1f ms, %zu vertices, hash %016llx: %s\n",
      name.c_str(), rows.size() / 3, threads, end - start, now() - end, hull.vertices.size(),
      static_cast<unsigned long long>(hash), c.valid ? "certified" : c.reason.c_str());
  std::fflush(stdout);
  if (!c.valid) std::exit(1);
}

int run(int argc, char** argv) {
  std::uint64_t n = 1000000;
  unsigned repeat = 3;
  std::vector<unsigned> threads = {1, 2};
  bool certify_them = false;
  std::vector<std::string> names;
  for (int i = 1; i < argc; ++i) {
    const std::string_view a = argv[i];
    if (a == "--certify") {
      certify_them = true;
    } else if (i + 1 < argc && a == "--n") {
      n = std::strtoull(argv[++i], nullptr, 10);
    } else if (i + 1 < argc && a == "--repeat") {
      repeat = static_cast<unsigned>(std::max(1, std::atoi(argv[++i])));
    } else if (i + 1 < argc && a == "--threads") {
      threads.clear();
      char* at = argv[++i];
      while (*at != 0) {
        threads.push_back(static_cast<unsigned>(std::strtoul(at, &at, 10)));
        at += *at == ',';
      }
    } else if (workloads().count(a) != 0) {
      names.emplace_back(a);
    } else {
      std::fprintf(stderr, "engine_bench: no workload '%s'; there are:", argv[i]);
      for (const auto& w : workloads()) std::fprintf(stderr, " %s", w.first.c_str());
      std::fprintf(stderr, "\n");
      return 2;
    }
  }
  if (names.empty())
    for (const auto& w : workloads()) names.push_back(w.first);
  for (const std::string& name : names) {
    const Rows rows = workloads().find(name)->second(n);
    for (const unsigned t : threads)
      certify_them ? certified(name, rows, t) : engine_alone(name, rows, t, repeat);
  }
  return 0;
}

}  // namespace
}  // namespace cullhull::internal

int main(int argc, char** argv) { return cullhull::internal::run(argc, argv); }
