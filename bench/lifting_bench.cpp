// Triangulations beside Qhull's (as SciPy calls it) and, where it was found, CGAL's sequential
// ones: in turns over the same points.
//
//     lifting_bench [--n N,N] [--d D,D] [--repeat K] [--no-qhull] [WORKLOAD ...]
//
// Workloads: uniform, clustered, grid, sphere, lines, or the name of a file of points, whose first
// D coordinates are taken. Prints medians in ms, rivals by ours, and checks that all have as many
// cells where no two are of one sphere.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <random>
#include <string>
#include <vector>

#include "cullhull/io.hpp"
#include "cullhull/triangulation.hpp"
#include "timing.hpp"

#ifdef CULLHULL_HAVE_CGAL
#include <CGAL/Delaunay_triangulation_2.h>
#include <CGAL/Delaunay_triangulation_3.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#endif
#ifdef CULLHULL_HAVE_QHULL
#include <libqhull_r/qhull_ra.h>
#endif

namespace cullhull::bench {
namespace {

using Rows = std::vector<double>;

Rows make_points(const std::string& name, std::uint64_t n, unsigned d) {
  std::mt19937_64 random(1);
  const auto unit = [&] { return std::ldexp(static_cast<double>(random() >> 11), -53); };
  std::normal_distribution<double> normal;
  const auto width =
      static_cast<std::uint64_t>(std::llround(std::pow(static_cast<double>(n), 1.0 / d)));
  Rows rows;
  for (std::uint64_t i = 0; i < n; ++i) {
    const double size = std::ldexp(1.0, -static_cast<int>(random() % 20));
    std::uint64_t rest = i;
    double square = 0;
    const double along = unit();
    const double line = static_cast<double>(random() % 16);
    for (unsigned j = 0; j < d; ++j) {
      double v = 0;
      if (name == "uniform") v = unit();
      if (name == "clustered") v = unit() * size + static_cast<double>(random() % 7);
      if (name == "grid") v = static_cast<double>(rest % width);
      if (name == "sphere") v = normal(random);
      if (name == "lines") v = j == 0 ? along : line * (j + 1) + along * j;
      rest /= width;
      square += v * v;
      rows.push_back(v);
    }
    if (name != "sphere") continue;
    for (unsigned j = 0; j < d; ++j) rows[i * d + j] /= std::sqrt(square);
  }
  return rows;
}

bool made(const std::string& name) {
  for (const char* known : {"uniform", "clustered", "grid", "sphere", "lines"})
    if (name == known) return true;
  return false;
}

Rows points_of(const std::string& name, std::uint64_t n, unsigned d) {
  if (made(name)) return make_points(name, n, d);
  const PointFile file = open_points(name);
  const PointView& view = file.points();
  Rows rows;
  for (std::uint64_t i = 0; i < std::min<std::uint64_t>(n, view.count); ++i)
    for (unsigned j = 0; j < d; ++j) rows.push_back(view.at(i, j));
  return rows;
}

struct Timed {
  std::vector<double> seconds;
  std::uint64_t cells = 0;
};

void ours(const Rows& rows, unsigned d, unsigned threads, Timed& out, bool& ties) {
  TriangulationOptions options;
  options.threads = threads;
  Triangulation t;
  out.seconds.push_back(seconds_of(
      [&] { t = delaunay(PointView::row_major(rows.data(), rows.size() / d, d), options); }));
  out.cells = t.size();
  ties = !t.cell_groups.empty();
}

void cgal([[maybe_unused]] const Rows& rows, [[maybe_unused]] unsigned d,
          [[maybe_unused]] Timed& out) {
#ifdef CULLHULL_HAVE_CGAL
  using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
  if (d == 2) {
    std::vector<Kernel::Point_2> p;
    for (std::size_t i = 0; i < rows.size(); i += 2) p.emplace_back(rows[i], rows[i + 1]);
    CGAL::Delaunay_triangulation_2<Kernel> t;
    out.seconds.push_back(seconds_of([&] { t.insert(p.begin(), p.end()); }));
    out.cells = t.number_of_faces();
  } else if (d == 3) {
    std::vector<Kernel::Point_3> p;
    for (std::size_t i = 0; i < rows.size(); i += 3)
      p.emplace_back(rows[i], rows[i + 1], rows[i + 2]);
    CGAL::Delaunay_triangulation_3<Kernel> t;
    out.seconds.push_back(seconds_of([&] { t.insert(p.begin(), p.end()); }));
    out.cells = t.number_of_finite_cells();
  }
#endif
}

void qhull([[maybe_unused]] const Rows& rows, [[maybe_unused]] unsigned d,
           [[maybe_unused]] Timed& out) {
#ifdef CULLHULL_HAVE_QHULL
  static std::FILE* const nowhere = std::fopen("/dev/null", "w");
  std::string command = d < 5 ? "qhull d Qbb Qc Qz Q12" : "qhull d Qbb Qc Qz Qx Q12";
  Rows copy = rows;  // which Qz and Qbb change
  out.seconds.push_back(seconds_of([&] {
    qhT qh;
    qh_zero(&qh, nowhere);
    qh_new_qhull(&qh, static_cast<int>(d), static_cast<int>(copy.size() / d), copy.data(), 0,
                 command.data(), nowhere, nowhere);
    qh_triangulate(&qh);
    int blocks = 0, bytes = 0;
    qh_freeqhull(&qh, !qh_ALL);
    qh_memfreeshort(&qh, &blocks, &bytes);
  }));
#endif
}

void measure(const std::string& name, std::uint64_t n, unsigned d, unsigned repeat,
             bool with_qhull) {
  const Rows rows = points_of(name, n, d);
  Timed all, one, rival, scipys;
  bool ties = false;
  for (unsigned k = 0; k < repeat; ++k) {
    ours(rows, d, 0, all, ties);
    ours(rows, d, 1, one, ties);
    cgal(rows, d, rival);
    if (with_qhull && k < 3) qhull(rows, d, scipys);
  }
  const double base = median(all.seconds);
  std::printf("%-12s %uD %8zu  ours %9.3f  one thread %9.3f", name.c_str(), d, rows.size() / d,
              1e3 * base, 1e3 * median(one.seconds));
  if (!rival.seconds.empty())
    std::printf("  CGAL %9.3f (%.2f)", 1e3 * median(rival.seconds), median(rival.seconds) / base);
  if (!scipys.seconds.empty())
    std::printf("  Qhull %9.3f (%.2f)", 1e3 * median(scipys.seconds),
                median(scipys.seconds) / base);
  const bool differs = rival.cells != 0 && rival.cells != all.cells && !ties;
  std::printf("  cells %llu%s\n", static_cast<unsigned long long>(all.cells),
              differs ? ", CGAL HAS OTHERS" : "");
  std::fflush(stdout);
}

std::vector<std::uint64_t> numbers(const char* list) {
  std::vector<std::uint64_t> out;
  for (const char* at = list; *at != '\0';) {
    char* end = nullptr;
    out.push_back(static_cast<std::uint64_t>(std::strtod(at, &end)));
    at = *end == ',' ? end + 1 : end;
    if (end == list || (*end != ',' && *end != '\0')) std::exit(2);
  }
  return out;
}

}  // namespace
}  // namespace cullhull::bench

int main(int argc, char** argv) {
  using namespace cullhull::bench;
  std::vector<std::uint64_t> sizes{1000, 100000}, dimensions{2, 3};
  unsigned repeat = 3;
  bool with_qhull = true;
  std::vector<std::string> workloads;
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    if (word == "--n" && i + 1 < argc)
      sizes = numbers(argv[++i]);
    else if (word == "--d" && i + 1 < argc)
      dimensions = numbers(argv[++i]);
    else if (word == "--repeat" && i + 1 < argc)
      repeat = static_cast<unsigned>(numbers(argv[++i])[0]);
    else if (word == "--no-qhull")
      with_qhull = false;
    else
      workloads.push_back(word);
  }
  if (workloads.empty()) workloads = {"uniform", "clustered", "grid", "sphere", "lines"};
  for (const std::uint64_t d : dimensions)
    for (const std::uint64_t n : sizes)
      for (const std::string& name : workloads)
        measure(name, n, static_cast<unsigned>(d), repeat, with_qhull);
  return 0;
}
