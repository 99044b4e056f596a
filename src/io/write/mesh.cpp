#include "io/write/mesh.hpp"

#include <algorithm>
#include <charconv>

#include "cullhull/error.hpp"
#include "cullhull/hull.hpp"

namespace cullhull::internal {
namespace {

/// From point ids to positions in hull.vertices.
class VertexNumbers {
 public:
  explicit VertexNumbers(const std::vector<std::uint64_t>& ids) {
    sorted_.reserve(ids.size());
    for (std::uint32_t i = 0; i < ids.size(); ++i) sorted_.push_back({ids[i], i});
    std::sort(sorted_.begin(), sorted_.end());
  }
  std::uint32_t of(std::uint64_t id) const {
    const auto it = std::lower_bound(sorted_.begin(), sorted_.end(), std::pair{id, 0U});
    if (it == sorted_.end() || it->first != id)
      throw Error(ErrorCode::invalid_argument, "hull names point ", id,
                  ", which is not one of its vertices");
    return it->second;
  }

 private:
  std::vector<std::pair<std::uint64_t, std::uint32_t>> sorted_;
};

}  // namespace

void triangulate(HullMesh& mesh) {
  const std::size_t count = mesh.triangles.size() / 3;
  mesh.edges += count - mesh.polygons.size();
  mesh.polygons.items.assign(mesh.triangles.begin(), mesh.triangles.end());
  mesh.polygons.offsets.clear();
  for (std::size_t t = 0; t <= count; ++t) mesh.polygons.offsets.push_back(3 * t);
}

HullMesh make_mesh(const Coordinates& points, const Hull& hull, const std::string& format,
                   Faces faces) {
  if (hull.dimension != 2 && hull.dimension != 3)
    throw Error(ErrorCode::invalid_argument, ".", format, " holds hulls of 2D and 3D points, not ",
                hull.dimension, "D; .json and .txt hold any");
  HullMesh mesh;
  mesh.coordinates.reserve(3 * hull.vertices.size());
  for (const std::uint64_t id : hull.vertices)
    for (std::uint32_t j = 0; j < 3; ++j)
      mesh.coordinates.push_back(j < hull.dimension ? points.at(id, j) : 0.0);

  if (hull.affine_dimension == 2) {
    // One polygon: hull.vertices is its boundary in order.
    const auto n = static_cast<std::uint32_t>(hull.vertices.size());
    for (std::uint32_t i = 0; i < n; ++i) mesh.polygons.items.push_back(i);
    mesh.polygons.offsets.push_back(n);
    for (std::uint32_t i = 1; i + 1 < n; ++i)
      for (const std::uint32_t v : {0U, i, i + 1}) mesh.triangles.push_back(v);
    mesh.edges = n;
  } else if (hull.affine_dimension == 3) {
    const VertexNumbers number(hull.vertices);
    mesh.polygons.offsets = hull.facets.offsets;
    for (const std::uint64_t id : hull.facets.items) mesh.polygons.items.push_back(number.of(id));
    for (const std::uint64_t id : hull.simplices) mesh.triangles.push_back(number.of(id));
    mesh.edges = hull.facets.items.size() / 2;
  }
  if (in_triangles(faces, format)) triangulate(mesh);
  return mesh;
}

void append_number(std::string& out, double value) {
  char text[40];
  const auto r = std::to_chars(text, text + sizeof text, value);
  out.append(text, r.ptr);
}

void append_number(std::string& out, std::uint64_t value) {
  char text[24];
  const auto r = std::to_chars(text, text + sizeof text, value);
  out.append(text, r.ptr);
}

}  // namespace cullhull::internal
