// CGAL's convex_hull_2 and convex_hull_3 (exact predicates, inexact constructions) on a .npy of
// doubles: writes the seconds and then the extreme points, all as doubles in binary. With a number
// of sets to divide the points into, the seconds of each instead. A separate program because CGAL
// is GPL: nothing of ours links it, `cullhull bench rivals` runs it where it is installed.
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/convex_hull_2.h>
#include <CGAL/convex_hull_3.h>

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <iterator>
#include <vector>

#include "cullhull/io.hpp"
#include "timing.hpp"

namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using cullhull::PointView;
using cullhull::bench::seconds_of;

double hull_2(const PointView& p, std::vector<double>& extreme) {
  std::vector<Kernel::Point_2> points, hull;
  for (std::uint64_t i = 0; i < p.count; ++i) points.emplace_back(p.at(i, 0), p.at(i, 1));
  const double seconds = seconds_of(
      [&] { CGAL::convex_hull_2(points.begin(), points.end(), std::back_inserter(hull)); });
  for (const auto& v : hull) extreme.insert(extreme.end(), {v.x(), v.y()});
  return seconds;
}

double hull_3(const PointView& p, std::vector<double>& extreme) {
  std::vector<Kernel::Point_3> points;
  for (std::uint64_t i = 0; i < p.count; ++i)
    points.emplace_back(p.at(i, 0), p.at(i, 1), p.at(i, 2));
  CGAL::Surface_mesh<Kernel::Point_3> mesh;
  const double seconds =
      seconds_of([&] { CGAL::convex_hull_3(points.begin(), points.end(), mesh); });
  for (const auto v : mesh.vertices()) {
    const Kernel::Point_3& at = mesh.point(v);
    extreme.insert(extreme.end(), {at.x(), at.y(), at.z()});
  }
  return seconds;
}

double hull(const PointView& p, std::vector<double>& extreme) {
  return p.dimension == 2 ? hull_2(p, extreme) : hull_3(p, extreme);
}

std::vector<double> seconds_of_sets(const PointView& points, std::uint64_t sets) {
  std::vector<double> seconds, ignored;
  PointView set = points;
  set.count = points.count / sets;
  for (std::uint64_t i = 0; i < sets; ++i) {
    ignored.clear();
    set.data = points.address(i * set.count, 0);
    seconds.push_back(hull(set, ignored));
  }
  return seconds;
}

}  // namespace

int main(int argc, char** argv) try {
  const std::uint64_t sets = argc == 3 ? std::strtoull(argv[2], nullptr, 10) : 0;
  if (argc != 2 && sets == 0) {
    std::fputs("usage: cullhull-rival-cgal POINTS.npy [SETS]\n", stderr);
    return 2;
  }
  const cullhull::PointFile file = cullhull::open_points(argv[1]);
  const PointView& p = file.points();
  if (p.dimension != 2 && p.dimension != 3) {
    std::fputs("cullhull-rival-cgal: 2D and 3D only\n", stderr);
    return 1;
  }
  std::vector<double> out;
  if (sets > 0) {
    out = seconds_of_sets(p, sets);
  } else {
    out.push_back(0);
    const double seconds = hull(p, out);
    out[0] = seconds;
  }
  return std::fwrite(out.data(), sizeof(double), out.size(), stdout) == out.size() ? 0 : 1;
} catch (const std::exception& e) {
  std::fprintf(stderr, "cullhull-rival-cgal: %s\n", e.what());
  return 1;
}
