// Against CGAL's exact predicates in the plane and in space, on sets too large for linear programs.
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/convex_hull_2.h>
#include <CGAL/convex_hull_3.h>

#include "all_paths.hpp"
#include "point_sets.hpp"

namespace cullhull::testing_support::cgal_oracle_test {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;

/// Lowest ids of the points equal to `vertices` (rows of d), ascending.
Ids ids_of(const PointSet& s, const std::vector<std::vector<double>>& vertices) {
  std::map<std::vector<double>, std::uint64_t> lowest;
  for (std::uint64_t i = 0; i < s.count(); ++i)
    lowest.emplace(std::vector<double>(s.row(i), s.row(i) + s.dimension), i);
  Ids ids;
  for (const auto& v : vertices) ids.push_back(lowest.at(v));
  std::sort(ids.begin(), ids.end());
  return ids;
}

Ids cgal_2d(const PointSet& s) {
  std::vector<Kernel::Point_2> points, hull;
  for (std::uint64_t i = 0; i < s.count(); ++i) points.emplace_back(s.row(i)[0], s.row(i)[1]);
  CGAL::convex_hull_2(points.begin(), points.end(), std::back_inserter(hull));
  std::vector<std::vector<double>> rows;
  for (const auto& p : hull) rows.push_back({p.x(), p.y()});
  return ids_of(s, rows);
}

Ids cgal_3d(const PointSet& s) {
  std::vector<Kernel::Point_3> points;
  for (std::uint64_t i = 0; i < s.count(); ++i)
    points.emplace_back(s.row(i)[0], s.row(i)[1], s.row(i)[2]);
  std::vector<Kernel::Point_3> extreme;
  CGAL::extreme_points_3(points, std::back_inserter(extreme));
  std::vector<std::vector<double>> rows;
  for (const auto& p : extreme) rows.push_back({p.x(), p.y(), p.z()});
  return ids_of(s, rows);
}

/// Extreme points of a set whose points all have z = -1 or z = 1: a face of the hull lies in either
/// plane, so they are the extreme points of either plane's points.
Ids cgal_in_two_planes(const PointSet& s) {
  Ids ids;
  for (const double z : {-1.0, 1.0}) {
    PointSet in_plane = named("plane", 2);
    Ids id_of;
    for (std::uint64_t i = 0; i < s.count(); ++i) {
      if (s.row(i)[2] != z) continue;
      in_plane.add({s.row(i)[0], s.row(i)[1]});
      id_of.push_back(i);
    }
    for (const std::uint64_t i : cgal_2d(in_plane)) ids.push_back(id_of[i]);
  }
  std::sort(ids.begin(), ids.end());
  return ids;
}

TEST(Cgal, Plane) {
  for (const char* shape : {"ball", "cube", "octahedron", "gauss", "sphere"}) {
    const PointSet s = random_set(shape, 20000, 2, 3);
    expect_everywhere(s, cgal_2d(s));
  }
  for (int side : {30, 3000}) {
    const PointSet s = random_grid(20000, 2, side, 0x1p40, 5);
    expect_everywhere(s, cgal_2d(s));
  }
}

TEST(Cgal, Space) {
  for (const char* shape : {"ball", "cube", "octahedron", "gauss", "sphere"}) {
    const PointSet s = random_set(shape, 5000, 3, 4);
    expect_everywhere(s, cgal_3d(s));
  }
}

TEST(Cgal, SpaceWhereManyPointsAreCoplanarOrNearly) {
  for (const PointSet& s : {random_grid(10000, 3, 40, 0, 6), random_grid(5000, 3, 1000, 0x1p40, 7),
                            cylinder(3000, 8), cone(2000, 9), cospherical(3, 2501)})
    expect_everywhere(s, cgal_3d(s));
}

// In space CGAL takes minutes for what it does in the plane in a moment; that the planes say the
// same is seen on a small set.
TEST(Cgal, TwoCircles) {
  const PointSet small = two_circles(1000, 7);
  EXPECT_EQ(cgal_in_two_planes(small), cgal_3d(small));
  expect_everywhere(small, cgal_3d(small));
  const PointSet large = two_circles(1000000, 7);
  expect_everywhere(large, cgal_in_two_planes(large), Paths::reference);
}

}  // namespace cullhull::testing_support::cgal_oracle_test
