// Many small hulls in one call, compared with Qhull in a loop on one core: millions of points per
// second.
//   bench/batch_bench [SETS]
#include <libqhull_r/qhull_ra.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <vector>

#include "cullhull/batch.hpp"
#include "cullhull/generate.hpp"
#include "timing.hpp"

namespace {

using namespace cullhull;

using bench::median_seconds;

/// Returns the number of vertices that Qhull finds in all sets.
std::uint64_t qhull_loop(std::vector<double>& points, unsigned d,
                         const std::vector<std::uint64_t>& offsets) {
  std::uint64_t vertices = 0;
  char flags[] = "qhull Pp";
  for (std::size_t i = 0; i + 1 < offsets.size(); ++i) {
    qhT qh;
    qh_zero(&qh, stderr);
    if (qh_new_qhull(&qh, static_cast<int>(d), static_cast<int>(offsets[i + 1] - offsets[i]),
                     points.data() + offsets[i] * d, 0, flags, nullptr, stderr) == 0)
      vertices += static_cast<std::uint64_t>(qh.num_vertices);
    int a = 0, b = 0;
    qh_freeqhull(&qh, !qh_ALL);
    qh_memfreeshort(&qh, &a, &b);
  }
  return vertices;
}

void run(const char* shape, unsigned d, std::uint64_t sets) {
  std::vector<std::uint64_t> offsets{0};
  for (std::uint64_t i = 0; i < sets; ++i) offsets.push_back(offsets.back() + 30 + i * 37 % 71);
  std::vector<double> points = generate(shape, offsets.back(), d);
  const PointView view = PointView::row_major(points.data(), offsets.back(), d);
  const double n = static_cast<double>(offsets.back());
  std::uint64_t ours = 0;
  std::printf("%uD %s, %llu sets of 30 to 100 points\n", d, shape,
              static_cast<unsigned long long>(sets));
  for (const unsigned threads : {1U, 0U}) {
    Options options;
    options.threads = threads;
    const double t = median_seconds(
        3, [&] { ours = convex_hulls(view, offsets, options).vertices.items.size(); });
    std::printf("  %-12s %8.2f M points/s, %6.2f us a hull\n",
                threads == 1 ? "one core" : "all cores", n / t * 1e-6,
                t / static_cast<double>(sets) * 1e6);
  }
  const std::uint64_t few = std::max<std::uint64_t>(1, sets / 20);
  const std::vector<std::uint64_t> head(offsets.begin(),
                                        offsets.begin() + static_cast<std::ptrdiff_t>(few) + 1);
  std::uint64_t theirs = 0;
  const double t = median_seconds(3, [&] { theirs = qhull_loop(points, d, head); });
  const std::uint64_t same = convex_hulls(view, head).vertices.items.size();
  std::printf(
      "  %-12s %8.2f M points/s, one core; vertices of the first %llu sets: %llu, ours %llu\n",
      "Qhull", static_cast<double>(head.back()) / t * 1e-6, static_cast<unsigned long long>(few),
      static_cast<unsigned long long>(theirs), static_cast<unsigned long long>(same));
}

}  // namespace

int main(int argc, char** argv) {
  const std::uint64_t sets = argc > 1 ? std::strtoull(argv[1], nullptr, 10) : 100'000;
  run("gauss", 3, sets);
  run("ball", 3, sets);
  run("sphere", 3, sets);
  run("gauss", 2, sets);
  run("ball", 2, sets);
  run("gauss", 4, sets / 10);
}
