// The time of the certificate, by phase, compared with that of the hull.
//
//     certify_bench [--repeat N] [--threads N] [SHAPE DIMENSION COUNT]...
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <utility>
#include <vector>

#include "cullhull/certify.hpp"
#include "cullhull/generate.hpp"

namespace {

using namespace cullhull;
using Clock = std::chrono::steady_clock;

double milliseconds(Clock::time_point from, Clock::time_point to) {
  return std::chrono::duration<double, std::milli>(to - from).count();
}

struct Row {
  std::string shape;
  unsigned dimension;
  std::uint64_t count;
};

void run(const Row& row, unsigned threads, unsigned repeats) {
  const std::vector<double> coordinates = generate(row.shape, row.count, row.dimension);
  const PointView points = PointView::row_major(coordinates.data(), row.count, row.dimension);
  Options options;
  options.threads = threads;
  std::vector<double> hull_times, certify_times;
  std::string phases;
  bool valid = true;
  Hull hull;
  for (unsigned i = 0; i < repeats; ++i) {
    hull = Hull();
    auto begin = Clock::now();
    hull = convex_hull(points, options);
    hull_times.push_back(milliseconds(begin, Clock::now()));
    Options watched = options;
    std::vector<Clock::time_point> marks;
    watched.progress = [&](const char*, double) { marks.push_back(Clock::now()); };
    begin = Clock::now();
    valid = certify(points, hull, watched).valid && valid;
    certify_times.push_back(milliseconds(begin, Clock::now()));
    phases.clear();
    for (std::size_t m = 0; m + 1 < marks.size(); ++m)
      phases += " " + std::to_string(milliseconds(marks[m], marks[m + 1]));
  }
  std::sort(hull_times.begin(), hull_times.end());
  std::sort(certify_times.begin(), certify_times.end());
  const double h = hull_times[repeats / 2], c = certify_times[repeats / 2];
  std::printf("%s %uD %llu, %zu vertices: hull %.1f ms, certify %.1f ms (%.2f)%s;%s\n",
              row.shape.c_str(), row.dimension, static_cast<unsigned long long>(row.count),
              hull.vertices.size(), h, c, c / h, valid ? "" : " NOT VALID", phases.c_str());
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  unsigned threads = 0, repeats = 3;
  std::vector<Row> rows;
  for (int i = 1; i < argc;) {
    const std::string a = argv[i];
    if (a == "--repeat" && i + 1 < argc) {
      repeats = static_cast<unsigned>(std::max(1, std::atoi(argv[i + 1])));
      i += 2;
    } else if (a == "--threads" && i + 1 < argc) {
      threads = static_cast<unsigned>(std::atoi(argv[i + 1]));
      i += 2;
    } else if (i + 2 < argc) {
      rows.push_back({a, static_cast<unsigned>(std::atoi(argv[i + 1])),
                      static_cast<std::uint64_t>(std::atof(argv[i + 2]))});
      i += 3;
    } else {
      std::fprintf(stderr, "certify_bench: what is '%s'?\n", argv[i]);
      return 2;
    }
  }
  if (rows.empty())
    rows = {{"ball", 3, 8'000'000},  {"gauss", 3, 10'000'000}, {"sphere", 3, 1'000'000},
            {"ball", 2, 10'000'000}, {"ball", 4, 8'000'000},   {"sphere", 4, 100'000},
            {"ball", 5, 1'000'000},  {"sphere", 5, 10'000},    {"ball", 6, 100'000}};
  for (const Row& row : rows) run(row, threads, repeats);
  return 0;
}
