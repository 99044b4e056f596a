// The hulls of a cube's corners and of points on its surface, through the package's targets alone.
#include <cstdint>
#include <cstdio>
#include <cullhull/cullhull.hpp>
#include <limits>
#include <string>
#include <vector>
#ifdef CONSUMER_HAS_IO
#include <cullhull/io.hpp>
#endif

namespace {

/// Points of a lattice on the six sides of a cube, in an order without a pattern. Every facet of
/// the hull is merged from thousands of simplices.
std::vector<double> cube_surface(std::size_t count) {
  std::vector<double> points;
  std::uint64_t state = 1;
  const auto below = [&](unsigned n) {
    state = state * 6364136223846793005 + 1442695040888963407;
    return static_cast<unsigned>((state >> 33) % n);
  };
  for (std::size_t i = 0; i < count; ++i) {
    double p[3] = {below(1025) / 1024.0, below(1025) / 1024.0, below(1025) / 1024.0};
    p[below(3)] = below(2);
    points.insert(points.end(), p, p + 3);
  }
  for (unsigned corner = 0; corner < 8; ++corner)
    for (unsigned axis = 0; axis < 3; ++axis) points[3 * corner + axis] = corner >> axis & 1;
  return points;
}

/// Hull and certificate use most of the library: a project without a build type compiles it
/// without optimisation, where the linker keeps one copy of each inline function.
bool certifies_a_cube() {
  const std::vector<double> points = cube_surface(20000);
  const auto view = cullhull::PointView::row_major(points.data(), points.size() / 3, 3);
  const cullhull::Hull hull = cullhull::convex_hull(view);
  const cullhull::Certificate certificate = cullhull::certify(view, hull);
  std::printf("%zu vertices, %zu facets, volume %g, certified: %s\n", hull.vertices.size(),
              hull.facets.size(), hull.volume, certificate.valid ? "yes" : "no");
  return certificate.valid && hull.facets.size() == 6 && hull.volume == 1;
}

}  // namespace

int main() {
  double points[9][3] = {};
  for (int i = 0; i < 8; ++i)
    for (int j = 0; j < 3; ++j) points[i][j] = (i >> j & 1) != 0 ? 1.0 : -1.0;
  const cullhull::PointView view = points;
  const cullhull::Hull hull = cullhull::convex_hull(points);
  if (cullhull::version() != std::string(CULLHULL_VERSION)) return 1;
  std::printf("%zu vertices, %zu facets, volume %g\n", hull.vertices.size(), hull.facets.size(),
              hull.volume);
  if (!certifies_a_cube()) return 1;
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
