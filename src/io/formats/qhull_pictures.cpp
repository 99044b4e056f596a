// A hull of 2D or 3D points in Qhull's formats for Geomview, Mathematica and Maple.
#include <cstdio>

#include "cullhull/error.hpp"
#include "io/formats/qhull_text.hpp"
#include "io/write/mesh.hpp"

namespace cullhull::internal {
namespace {

void require_picture(const Hull& hull, const char* what) {
  if ((hull.dimension == 2 || hull.dimension == 3) &&
      hull.affine_dimension == static_cast<int>(hull.dimension))
    return;
  throw Error(ErrorCode::invalid_argument, "--format ", what,
              " draws hulls of 2D and 3D points that span their space, not one of dimension ",
              hull.affine_dimension, " among points of dimension ", hull.dimension);
}

/// "{x, y, z}" with eight digits, as Qhull prints for these programs.
std::string bracketed(const Coordinates& points, std::uint64_t id, char open, char close) {
  std::string out(1, open);
  for (std::uint32_t j = 0; j < points.dimension; ++j) {
    char number[400];
    std::snprintf(number, sizeof number, "%s%16.8f", j > 0 ? ", " : "", points.at(id, j));
    out += number;
  }
  return out += close;
}

/// A list of facets, each as its corners in brackets.
std::string bracketed_facets(const Coordinates& points, const Hull& hull, const char* before_each,
                             const char* after_each, char open, char close) {
  std::string out;
  const bool plane = hull.dimension == 2;
  for (std::uint64_t i = 0; i < hull.facet_count(); ++i) {
    if (i > 0) out += plane ? "," : ",\n";
    out += before_each;
    const auto ids = qhull_facet(hull, i, 0);
    for (std::size_t j = 0; j < ids.size(); ++j) {
      if (j > 0) out += plane ? ", " : ",\n";
      out += bracketed(points, ids[j], open, close);
    }
    out += after_each;
    if (plane) out += '\n';
  }
  return out += plane ? "" : "\n";
}

/// Appends coordinates on a line, 0 as the third one in the plane.
void append_3d(std::string& out, const Coordinates& points, std::uint64_t id) {
  for (std::uint32_t j = 0; j < 3; ++j)
    append_padded(out, j < points.dimension ? points.at(id, j) : 0.0);
  out += '\n';
}

/// A colour that shows a facet's direction: its unit normal, mapped to [0, 1].
void append_colour(std::string& out, const Hull& hull, std::uint64_t facet) {
  const double* plane = hull.facet_planes.data() + facet * (std::uint64_t{hull.dimension} + 1);
  for (std::uint32_t j = 0; j < 3; ++j)
    append_padded(out, j < hull.dimension ? (plane[j] + 1) / 2 : 0.0);
  out += "1.0";
}

}  // namespace

std::string mathematica_text(const Coordinates& points, const Hull& hull) {
  require_picture(hull, "m");
  const char* const begin = hull.dimension == 2 ? "Line[{" : "Polygon[{";
  return "{\n" + bracketed_facets(points, hull, begin, "}]", '{', '}') + "}\n";
}

std::string maple_text(const Coordinates& points, const Hull& hull) {
  require_picture(hull, "FM");
  const std::string body = bracketed_facets(points, hull, "[", "]", '[', ']');
  return hull.dimension == 2 ? "PLOT(CURVES(\n" + body + "));\n"
                             : "PLOT3D(POLYGONS(\n" + body + "));\n";
}

std::string geomview_text(const Coordinates& points, const Hull& hull) {
  require_picture(hull, "G");
  const bool plane = hull.dimension == 2;
  std::string out = plane ? "{appearance {linewidth 3} LIST # cullhull\n"
                          : "{appearance {+edge -evert linewidth 2} LIST # cullhull\n";
  for (std::uint64_t i = 0; i < hull.facet_count(); ++i) {
    const auto ids = qhull_facet(hull, i, 0);
    const std::string count = std::to_string(ids.size());
    out += (plane ? "VECT 1 2 1 2 1 # f" : "{ OFF " + count + " 1 1 # f") + std::to_string(i);
    out += '\n';
    for (const std::uint64_t id : ids) append_3d(out, points, id);
    if (!plane) {
      out += count + ' ';
      for (std::size_t j = 0; j < ids.size(); ++j) out += std::to_string(j) + ' ';
    }
    append_colour(out, hull, i);
    out += plane ? "\n" : " }\n";
  }
  return out += "}\n";
}

}  // namespace cullhull::internal
