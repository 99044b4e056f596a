// The hull of points that are already in memory.
#include <cstdio>

#include "cullhull/cullhull.hpp"

int main() {
  const std::vector<double> points = cullhull::generate("ball", 100000, 3);    // x0 y0 z0 x1 ...
  const auto view = cullhull::PointView::row_major(points.data(), 100000, 3);  // copies nothing
  const cullhull::Hull hull = cullhull::convex_hull(view);
  std::printf("%zu of %zu points are extreme, %zu facets, volume %.6f\n", hull.vertices.size(),
              points.size() / 3, hull.facets.size(), hull.volume);
  return cullhull::certify(view, hull) ? 0 : 1;
}
