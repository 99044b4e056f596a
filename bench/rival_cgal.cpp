// CGAL's convex_hull_2 and convex_hull_3 (exact predicates, inexact constructions) on a .npy of
// doubles: prints the seconds and the number of vertices. A program of its own because CGAL is GPL:
// nothing of ours links it, `cullhull bench rivals` runs it where it is installed.
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/convex_hull_2.h>
#include <CGAL/convex_hull_3.h>

#include <chrono>
#include <cstdio>
#include <iterator>
#include <vector>

#include "cullhull/io.hpp"

namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;

template <class Work>
double seconds_of(Work&& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

}  // namespace

int main(int argc, char** argv) try {
  if (argc != 2) {
    std::fputs("usage: cullhull-rival-cgal POINTS.npy\n", stderr);
    return 2;
  }
  const cullhull::PointFile file = cullhull::open_points(argv[1]);
  const cullhull::PointView& p = file.points();
  double seconds = 0;
  std::size_t vertices = 0;
  if (p.dimension == 2) {
    std::vector<Kernel::Point_2> points, hull;
    for (std::uint64_t i = 0; i < p.count; ++i) points.emplace_back(p.at(i, 0), p.at(i, 1));
    seconds = seconds_of(
        [&] { CGAL::convex_hull_2(points.begin(), points.end(), std::back_inserter(hull)); });
    vertices = hull.size();
  } else if (p.dimension == 3) {
    std::vector<Kernel::Point_3> points;
    for (std::uint64_t i = 0; i < p.count; ++i)
      points.emplace_back(p.at(i, 0), p.at(i, 1), p.at(i, 2));
    CGAL::Surface_mesh<Kernel::Point_3> mesh;
    seconds = seconds_of([&] { CGAL::convex_hull_3(points.begin(), points.end(), mesh); });
    vertices = mesh.number_of_vertices();
  } else {
    std::fputs("cullhull-rival-cgal: 2D and 3D only\n", stderr);
    return 1;
  }
  std::printf("%.9f %zu\n", seconds, vertices);
} catch (const std::exception& e) {
  std::fprintf(stderr, "cullhull-rival-cgal: %s\n", e.what());
  return 1;
}
