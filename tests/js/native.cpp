// native FUNCTION DIMENSION NUMBER FLAG: what a module of bindings/js does, of the native library.
// Reads the number of points and of edges' ids, the coordinates and the ids; writes each part of
// the result behind its size in bytes, or the error.
#ifdef CULLHULL_JS_PLANE
#include "bindings/js/src/plane.cpp"
#else
#include "bindings/js/src/space.cpp"
#endif

#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

namespace {

template <class T>
std::vector<T> read(std::size_t count) {
  std::vector<T> values(count);
  if (std::fread(values.data(), sizeof(T), count, stdin) != count) std::exit(2);
  return values;
}

}  // namespace

int main(int count, char** arguments) {
  if (count != 5) return 2;
  const std::string name = arguments[1];
  const auto dimension = static_cast<std::uint32_t>(std::stoul(arguments[2]));
  const std::vector<std::uint32_t> sizes = read<std::uint32_t>(2);
  const std::vector<double> points = read<double>(std::size_t{sizes[0]} * dimension);
  const std::vector<std::uint32_t> ids = read<std::uint32_t>(sizes[1]);
  int status = 2;
#ifdef CULLHULL_JS_PLANE
  const bool flag = arguments[4][0] == '1';
  if (name == "hull") status = cullhull_hull(points.data(), sizes[0]);
  if (name == "delaunay") status = cullhull_delaunay(points.data(), sizes[0]);
  if (name == "voronoi") status = cullhull_voronoi(points.data(), sizes[0]);
  if (name == "constrained")
    status = cullhull_constrained(points.data(), sizes[0], ids.data(), sizes[1], flag);
  if (name == "concave")
    status = cullhull_concave(points.data(), sizes[0], std::stod(arguments[3]), flag);
#else
  if (name == "hull") status = cullhull_hull(points.data(), sizes[0], dimension);
  if (name == "delaunay") status = cullhull_delaunay(points.data(), sizes[0], dimension);
#endif
  if (status != 0) return std::fputs(cullhull_error(), stdout), status;
  for (const Part& part : parts) {
    std::fwrite(&part.size, sizeof part.size, 1, stdout);
    std::fwrite(part.data, 1, part.size, stdout);
  }
  return 0;
}
