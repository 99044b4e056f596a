// The hull of a cube's corners and its centre, through the package's targets alone.
#include <cstdio>
#include <cullhull/cullhull.hpp>
#include <limits>
#ifdef CONSUMER_HAS_IO
#include <cullhull/io.hpp>
#endif

int main() {
  double points[9][3] = {};
  for (int i = 0; i < 8; ++i)
    for (int j = 0; j < 3; ++j) points[i][j] = (i >> j & 1) != 0 ? 1.0 : -1.0;
  const auto view = cullhull::PointView::row_major(&points[0][0], 9, 3);
  const cullhull::Hull hull = cullhull::convex_hull(view);
  std::printf("%zu vertices, %zu facets, volume %g\n", hull.vertices.size(), hull.facets.size(),
              hull.volume);
  if (hull.vertices.size() != 8 || hull.facets.size() != 6 || hull.volume != 8) return 1;
  points[3][1] = std::numeric_limits<double>::quiet_NaN();
  try {  // errors cross the border of a shared library
    cullhull::convex_hull(view);
    return 1;
  } catch (const cullhull::Error& e) {
    if (e.code() != cullhull::ErrorCode::not_finite) return 1;
  }
  points[3][1] = 1;
#ifdef CONSUMER_HAS_IO
  if (cullhull::hull_to_qhull_text(view, hull, "Fx").empty()) return 1;
#endif
  return 0;
}
