// The module of space: points of any dimension, packed rows of doubles.
#include <algorithm>
#include <array>

#include "cullhull/hull.hpp"
#include "cullhull/triangulation.hpp"
#include "module.hpp"

using namespace cullhull;      // NOLINT: a program's only functions
using namespace cullhull::js;  // NOLINT

extern "C" {

int cullhull_hull(const double* points, std::uint32_t count, std::uint32_t dimension) {
  return guarded([&] {
    const Hull hull = convex_hull(PointView::row_major(points, count, dimension));
    struct Result {
      Array<std::uint32_t> vertices, simplices;
      std::array<double, 2> measures;
      std::array<std::uint32_t, 1> corners;
    };
    const auto& r = keep(Result{{hull.vertices.begin(), hull.vertices.end()},
                                {hull.simplices.begin(), hull.simplices.end()},
                                {hull.volume, hull.area},
                                {static_cast<std::uint32_t>(std::max(hull.affine_dimension, 0))}});
    hand_out(r.vertices, r.simplices, r.measures, r.corners);
  });
}

int cullhull_delaunay(const double* points, std::uint32_t count, std::uint32_t dimension) {
  return guarded([&] {
    struct Result {
      Triangulation triangulation;
      std::array<std::uint32_t, 1> corners;
    };
    Triangulation t = delaunay(PointView::row_major(points, count, dimension));
    const std::uint32_t corners = t.corners();
    const auto& r = keep(Result{std::move(t), {corners}});
    hand_out(r.triangulation.cells, r.triangulation.neighbours, r.corners);
  });
}
}
