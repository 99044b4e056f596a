#include "io/write/mesh.hpp"

#include <algorithm>
#include <charconv>
#include <numeric>

#include "cullhull/error.hpp"
#include "cullhull/hull.hpp"
#include "parallel/id_places.hpp"
#include "parallel/threads/run.hpp"

namespace cullhull::internal {
namespace {

/// From point ids to positions in hull.vertices.
class VertexNumbers {
 public:
  /// `ids` must not be empty.
  VertexNumbers(const std::vector<std::uint64_t>& ids, const Run& run) : sorted_(ids) {
    if (!std::is_sorted(ids.begin(), ids.end())) {
      order_.resize(ids.size());
      std::iota(order_.begin(), order_.end(), 0U);
      std::sort(order_.begin(), order_.end(), [&](auto a, auto b) { return ids[a] < ids[b]; });
      for (std::size_t i = 0; i < ids.size(); ++i) sorted_[i] = ids[order_[i]];
    }
    places_ = IdPlaces(sorted_, run);
  }
  VertexNumbers(const VertexNumbers&) = delete;
  VertexNumbers& operator=(const VertexNumbers&) = delete;

  /// Appends the numbers of these points.
  template <class Ids, class Numbers>
  void append(const Ids& ids, Numbers& numbers, const Run& run) const {
    const std::size_t before = numbers.size();
    numbers.resize(before + ids.size());
    run.each(ids.size(), light_grain, [&](std::uint64_t begin, std::uint64_t end) {
      for (std::uint64_t i = begin; i < end; ++i) numbers[before + i] = of(ids[i]);
    });
  }

 private:
  std::uint32_t of(std::uint64_t id) const {
    const std::uint32_t place = places_(id);
    if (place == sorted_.size())
      throw Error(ErrorCode::invalid_argument, "hull names point ", id,
                  ", which is not one of its vertices");
    return order_.empty() ? place : order_[place];
  }

  std::vector<std::uint64_t> sorted_;
  std::vector<std::uint32_t> order_;  ///< positions of the sorted ids; empty if they ascend
  IdPlaces places_;
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
    if (hull.vertices.empty())
      throw Error(ErrorCode::invalid_argument, "a hull of points in space has no vertices");
    const Options options;
    const Call call(options, true);
    const VertexNumbers numbers(hull.vertices, call.run);
    mesh.polygons.offsets = hull.facets.offsets;
    numbers.append(hull.facets.items, mesh.polygons.items, call.run);
    numbers.append(hull.simplices, mesh.triangles, call.run);
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
