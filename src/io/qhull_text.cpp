// Text as Qhull's `qconvex` prints it. Facets come in our order; orientation is Qhull's: det(v1 -
// v0, ..., x - v0) > 0 for x inside, so polygons in space run clockwise seen from outside.
#include <algorithm>
#include <cmath>

#include "cullhull/error.hpp"
#include "cullhull/io.hpp"
#include "io/mesh.hpp"

namespace cullhull {
namespace internal {
namespace {

/// "%6s ", as Qhull pads its numbers.
void append_padded(std::string& out, double v) {
  const std::size_t at = out.size();
  append_number(out, v);
  const std::size_t length = out.size() - at;
  if (length < 6) out.insert(at, 6 - length, ' ');
  out += ' ';
}

void append_line(std::string& out, std::uint64_t v) {
  append_number(out, v);
  out += '\n';
}

void append_point(std::string& out, const PointView& points, std::uint64_t id) {
  for (std::uint32_t j = 0; j < points.dimension; ++j) append_padded(out, points.at(id, j));
  out += '\n';
}

void append_ids(std::string& out, const std::uint64_t* ids, std::uint64_t count, bool flip_last) {
  for (std::uint64_t i = 0; i < count; ++i) {
    const bool swap = flip_last && count >= 2 && i + 2 >= count;
    append_number(out, ids[swap ? 2 * count - 3 - i : i]);
    out += ' ';
  }
  out += '\n';
}

std::vector<std::uint64_t> sorted_vertices(const Hull& hull) {
  std::vector<std::uint64_t> ids = hull.vertices;
  std::sort(ids.begin(), ids.end());
  return ids;
}

/// Facet i as Qhull would list its vertices; `simplex` is one of the facet's simplices.
void append_facet(std::string& out, const Hull& hull, std::uint64_t i, std::uint64_t simplex) {
  const std::uint64_t from = hull.facets.offsets[i], count = hull.facets.offsets[i + 1] - from;
  const std::uint64_t* ids = hull.facets.items.data() + from;
  const auto k = static_cast<std::uint64_t>(hull.affine_dimension);
  if (k == 3) {
    const std::vector<std::uint64_t> reversed(std::reverse_iterator(ids + count),
                                              std::reverse_iterator(ids));
    append_ids(out, reversed.data(), count, false);
  } else if (k > 3 && count == k) {
    append_ids(out, hull.simplices.data() + simplex * k, k, true);
  } else {
    append_ids(out, ids, count, false);
  }
}

/// A simplex of every facet.
std::vector<std::uint64_t> simplex_of_facet(const Hull& hull) {
  std::vector<std::uint64_t> of(hull.facet_count(), 0);
  for (std::uint64_t s = 0; s < hull.simplex_count(); ++s) of[hull.simplex_facets[s]] = s;
  return of;
}

/// i: 2D and 3D facets whole; above, facets that are no simplices are triangulated (Qhull does so
/// too, around an added centre).
std::string incidences(const Hull& hull) {
  std::string out;
  const auto k = static_cast<std::uint64_t>(std::max(hull.affine_dimension, 0));
  if (k > 3) {
    append_line(out, hull.simplex_count());
    for (std::uint64_t s = 0; s < hull.simplex_count(); ++s)
      append_ids(out, hull.simplices.data() + s * k, k, true);
  } else {
    append_line(out, hull.facet_count());
    for (std::uint64_t i = 0; i < hull.facet_count(); ++i) append_facet(out, hull, i, 0);
  }
  return out;
}

std::string off_like(const PointView& points, const Hull& hull) {
  std::string out;
  append_line(out, hull.dimension);
  append_number(out, points.count);
  out += ' ';
  append_number(out, hull.facet_count());
  out += ' ';
  append_line(out, hull.facet_neighbours.items.size() / 2);
  for (std::uint64_t i = 0; i < points.count; ++i) append_point(out, points, i);
  const std::vector<std::uint64_t> simplices = simplex_of_facet(hull);
  for (std::uint64_t i = 0; i < hull.facet_count(); ++i) {
    append_number(out, hull.facets.offsets[i + 1] - hull.facets.offsets[i]);
    out += ' ';
    append_facet(out, hull, i, simplices[i]);
  }
  return out;
}

std::string normals(const Hull& hull) {
  std::string out;
  const std::uint64_t width = std::uint64_t{hull.dimension} + 1;
  append_line(out, width);
  append_line(out, hull.facet_count());
  for (std::uint64_t i = 0; i < hull.facet_count(); ++i) {
    for (std::uint64_t j = 0; j < width; ++j) append_padded(out, hull.facet_planes[i * width + j]);
    out += '\n';
  }
  return out;
}

std::string vertex_coordinates(const PointView& points, const Hull& hull) {
  std::string out;
  append_line(out, hull.dimension);
  append_line(out, hull.vertices.size());
  for (const std::uint64_t id : sorted_vertices(hull)) append_point(out, points, id);
  return out;
}

/// FV: the average of the vertices.
std::string average_vertex(const PointView& points, const Hull& hull) {
  std::string out;
  append_number(out, std::uint64_t{hull.dimension});
  out += " 1\n";
  const std::vector<std::uint64_t> ids = sorted_vertices(hull);
  for (std::uint32_t j = 0; j < hull.dimension; ++j) {
    // Divided first, so that the sum of huge coordinates does not overflow.
    const auto n = static_cast<double>(ids.size());
    double sum = 0;
    for (const std::uint64_t id : ids) sum += points.at(id, j) / n;
    append_padded(out, sum);
  }
  out += '\n';
  return out;
}

}  // namespace
}  // namespace internal

std::string hull_to_qhull_text(const PointView& points, const Hull& hull, std::string_view what) {
  using namespace internal;
  std::string out;
  if (what == "Fx") {
    append_line(out, hull.vertices.size());
    for (const std::uint64_t id : hull.vertices) append_line(out, id);
    return out;
  }
  if (what == "i") return incidences(hull);
  if (what == "o") return off_like(points, hull);
  if (what == "n") return normals(hull);
  if (what == "p") return vertex_coordinates(points, hull);
  if (what == "FV") return average_vertex(points, hull);
  if (what == "FS") {
    // Qhull: the number of integers, then "2 area volume".
    out = std::string("0\n2 ");
    append_padded(out, hull.area);
    append_padded(out, hull.volume);
    out += '\n';
    return out;
  }
  throw Error(ErrorCode::invalid_argument,
              "unknown text format '" + std::string(what) + "'; known are Fx i o n p FV FS");
}

}  // namespace cullhull
