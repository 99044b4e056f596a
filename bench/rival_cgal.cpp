// Runs CGAL's convex_hull_2 or convex_hull_3 (exact predicates, inexact constructions) on a .npy
// file of doubles. Writes the seconds and then the extreme points, as doubles in binary; with a
// number of sets into which to divide the points, the seconds of each set instead; with the word
// `delaunay` or (3D with TBB) `delaunay-parallel`, the seconds of the triangulation and its number
// of simplices. It is a separate program because CGAL is GPL: no part of cullhull links it,
// `cullhull-bench` runs it where it is installed.
#include <CGAL/Delaunay_triangulation_2.h>
#include <CGAL/Delaunay_triangulation_3.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/convex_hull_2.h>
#include <CGAL/convex_hull_3.h>

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <iterator>
#include <string>
#include <vector>

#include "cullhull/io.hpp"
#include "timing.hpp"

namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using cullhull::PointView;
using cullhull::bench::seconds_of;
using cullhull::bench::settled_seconds;

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

/// Returns the seconds, then the number of simplices.
std::vector<double> delaunay_2(const PointView& p) {
  std::vector<Kernel::Point_2> points;
  for (std::uint64_t i = 0; i < p.count; ++i) points.emplace_back(p.at(i, 0), p.at(i, 1));
  CGAL::Delaunay_triangulation_2<Kernel> t;
  const double seconds =
      settled_seconds([&] { t.clear(); }, [&] { t.insert(points.begin(), points.end()); });
  return {seconds, t.dimension() < 2 ? 0.0 : static_cast<double>(t.number_of_faces())};
}

/// `lock`: empty, or the lock data structure for several threads.
template <class Triangulation, class... Lock>
std::vector<double> delaunay_3(const PointView& p, Lock*... lock) {
  std::vector<Kernel::Point_3> points;
  for (std::uint64_t i = 0; i < p.count; ++i)
    points.emplace_back(p.at(i, 0), p.at(i, 1), p.at(i, 2));
  Triangulation t(Kernel(), lock...);
  const double seconds =
      settled_seconds([&] { t.clear(); }, [&] { t.insert(points.begin(), points.end()); });
  return {seconds, t.dimension() < 3 ? 0.0 : static_cast<double>(t.number_of_finite_cells())};
}

/// Empty if there is no such triangulation.
std::vector<double> delaunay(const PointView& p, bool parallel) {
  if (!parallel && p.dimension == 2) return delaunay_2(p);
  if (!parallel && p.dimension == 3) return delaunay_3<CGAL::Delaunay_triangulation_3<Kernel>>(p);
#ifdef CGAL_LINKED_WITH_TBB
  if (parallel && p.dimension == 3) {
    using Data =
        CGAL::Triangulation_data_structure_3<CGAL::Triangulation_vertex_base_3<Kernel>,
                                             CGAL::Delaunay_triangulation_cell_base_3<Kernel>,
                                             CGAL::Parallel_tag>;
    using Parallel = CGAL::Delaunay_triangulation_3<Kernel, Data>;
    CGAL::Bbox_3 box;
    for (std::uint64_t i = 0; i < p.count; ++i)
      box += CGAL::Bbox_3(p.at(i, 0), p.at(i, 1), p.at(i, 2), p.at(i, 0), p.at(i, 1), p.at(i, 2));
    Parallel::Lock_data_structure locks(box, 50);
    return delaunay_3<Parallel>(p, &locks);
  }
#endif
  return {};
}

int write_doubles(const std::vector<double>& out) {
  return std::fwrite(out.data(), sizeof(double), out.size(), stdout) == out.size() ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) try {
  const std::string word = argc == 3 ? argv[2] : "";
  const bool lifted = word == "delaunay" || word == "delaunay-parallel";
  const std::uint64_t sets = std::strtoull(word.c_str(), nullptr, 10);
  if (argc != 2 && sets == 0 && !lifted) {
    std::fputs("usage: cullhull-rival-cgal POINTS.npy [SETS|delaunay|delaunay-parallel]\n", stderr);
    return 2;
  }
  const cullhull::PointFile file = cullhull::open_points(argv[1]);
  const PointView& p = file.points();
  if (p.dimension != 2 && p.dimension != 3) {
    std::fputs("cullhull-rival-cgal: 2D and 3D only\n", stderr);
    return 1;
  }
  std::vector<double> out;
  if (lifted) {
    out = delaunay(p, word == "delaunay-parallel");
    return out.empty() ? 1 : write_doubles(out);
  }
  if (sets > 0) {
    out = seconds_of_sets(p, sets);
  } else {
    out.push_back(0);
    const double seconds = hull(p, out);
    out[0] = seconds;
  }
  return write_doubles(out);
} catch (const std::exception& e) {
  std::fprintf(stderr, "cullhull-rival-cgal: %s\n", e.what());
  return 1;
}
