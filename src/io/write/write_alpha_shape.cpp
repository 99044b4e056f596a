// Alpha shapes as files.
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "cullhull/error.hpp"
#include "cullhull/triangulation_io.hpp"
#include "io/file_formats.hpp"
#include "io/formats/geometry_text.hpp"
#include "io/source.hpp"
#include "io/write/mesh.hpp"
#include "io/write/output_text.hpp"

namespace cullhull::internal {
namespace {

/// Only the points of these triangles.
HullMesh mesh_of(const PointView& points, const Array<std::uint32_t>& triangles) {
  std::vector<std::uint32_t> ids(triangles.begin(), triangles.end());
  std::sort(ids.begin(), ids.end());
  ids.erase(std::unique(ids.begin(), ids.end()), ids.end());
  HullMesh mesh;
  for (const std::uint32_t id : ids)
    for (std::uint32_t j = 0; j < 3; ++j)
      mesh.coordinates.push_back(j < points.dimension ? points.at(id, j) : 0.0);
  std::vector<std::pair<std::uint32_t, std::uint32_t>> edges;
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    const auto place = static_cast<std::uint32_t>(
        std::lower_bound(ids.begin(), ids.end(), triangles[i]) - ids.begin());
    mesh.polygons.items.push_back(place);
    mesh.triangles.push_back(place);
    if (i % 3 == 2) mesh.polygons.offsets.push_back(i + 1);
    edges.push_back(std::minmax(triangles[i], triangles[i % 3 == 2 ? i - 2 : i + 1]));
  }
  std::sort(edges.begin(), edges.end());
  mesh.edges = static_cast<std::uint64_t>(std::unique(edges.begin(), edges.end()) - edges.begin());
  return mesh;
}

/// In space the boundary; in the plane the triangles themselves.
HullMesh mesh_of(const PointView& points, const Triangulation& t, const AlphaShape& shape) {
  if (t.affine_dimension == 3) return mesh_of(points, shape.facets);
  Array<std::uint32_t> triangles;
  if (t.affine_dimension == 2)
    for (const std::uint32_t c : shape.cells)
      triangles.insert(triangles.end(), t.cell(c).begin(), t.cell(c).end());
  return mesh_of(points, triangles);
}

/// The ends of each connected part of points on a line, two after each other; equal points have one
/// representative.
std::vector<std::uint32_t> ends_of_parts(const PointView& points, const Triangulation& t,
                                         const AlphaShape& shape) {
  if (t.affine_dimension == 0 && !shape.cells.empty()) return {t.cells[0]};
  std::vector<std::uint32_t> ends(shape.facets.begin(), shape.facets.end());
  if (t.affine_dimension != 1) return {};
  const std::uint32_t axis = t.axes[0];
  std::sort(ends.begin(), ends.end(), [&](std::uint32_t a, std::uint32_t b) {
    return points.at(a, axis) < points.at(b, axis);
  });
  return ends;
}

/// Points and lines, where no polygon has an area.
void write_parts(const std::string& path, const std::string& f, const PointView& points,
                 const Triangulation& t, const AlphaShape& shape, const MapExtras& extras) {
  const std::vector<std::uint32_t> ends = ends_of_parts(points, t, shape);
  const std::size_t each = t.affine_dimension == 1 ? 2 : 1;
  const MapExtras all = columns_in_common(extras, ends.size() / each);
  write_map(path, f, ends.size() / each, "region", all, [&](std::uint64_t i) {
    return PlanePolygons{{ring_of(points, std::span(ends).subspan(i * each, each))}};
  });
}

void write_polygons(const std::string& path, const std::string& f, const PointView& points,
                    const Triangulation& t, const AlphaShape& shape, const MapExtras& extras) {
  const CellPolygons regions = cell_polygons(points, t, shape.cells);
  const MapExtras all = columns_in_common(extras, regions.polygon_count());
  write_map(path, f, regions.polygon_count(), "region", all,
            [&](std::uint64_t i) { return PlanePolygons{rings_of(regions, i, points)}; });
}

void write_json(const std::string& path, const Triangulation& t, const AlphaShape& shape,
                double alpha) {
  OutputText out(path);
  out.json("alpha_shape", {t.point_count, t.dimension, t.scalar}, [&](JsonWriter& w) {
    w.member("affine_dimension", t.affine_dimension);
    w.key("alpha");
    if (std::isnan(alpha))
      w.null();
    else
      w.value(alpha);
    w.rows("cells", shape.cells.size(), [&](JsonWriter& row, std::uint64_t i) {
      const auto corners = t.cell(shape.cells[i]);
      row.list(corners, 0, corners.size());
    });
    const std::size_t width = t.corners() > 1 ? t.corners() - 1 : 0;
    w.nested("facets", shape.facets, width);
  });
  out.commit();
}

[[noreturn]] void refuse_dimension(const std::string& f, const char* holds,
                                   std::uint32_t dimension) {
  throw Error(ErrorCode::invalid_argument, ".", f, " holds ", holds, ", not ", dimension, "D");
}

void check(const std::string& path, const std::string& f, std::uint32_t dimension) {
  if (is_mesh(f)) {
    if (dimension != 2 && dimension != 3)
      refuse_dimension(f, "shapes of 2D and 3D points", dimension);
  } else if (is_map(f)) {
    if (dimension != 2) refuse_dimension(f, "polygons of 2D points", dimension);
  } else if (f == "vtk") {
    if (dimension > 3) refuse_dimension(f, "cells of points of up to 3 dimensions", dimension);
  } else if (f != "json") {
    refuse_format(path, f, {OutputKind::triangulation});
  }
}

}  // namespace
}  // namespace cullhull::internal

namespace cullhull {

using namespace internal;

void check_alpha_shape_format(const std::string& path, std::uint32_t dimension) {
  check(path, output_format(path, "", "json"), dimension);
}

void write_alpha_shape(const std::string& path, const PointView& points, const Triangulation& t,
                       const AlphaShape& shape, double alpha, const std::string& format,
                       const MapExtras& extras) {
  require_triangulation_of(points, t);
  const auto below = [](const Array<std::uint32_t>& list, std::uint64_t end) {
    return std::all_of(list.begin(), list.end(), [end](std::uint32_t v) { return v < end; });
  };
  if (!below(shape.cells, t.size()) || !below(shape.facets, t.point_count))
    throw Error(ErrorCode::invalid_argument, "the shape is not that of the triangulation");
  const std::string f = output_format(path, format, "json");
  check(path, f, t.dimension);
  if (f == "json") return write_json(path, t, shape, alpha);
  if (f == "vtk") return write_vtk(path, points, t, shape.cells);
  if (is_map(f) && t.affine_dimension < 2) return write_parts(path, f, points, t, shape, extras);
  if (is_map(f)) return write_polygons(path, f, points, t, shape, extras);
  write_mesh(path, f, mesh_of(points, t, shape));
}

}  // namespace cullhull
