// Triangulations and Voronoi diagrams as files.
#include <algorithm>
#include <cmath>
#include <numeric>
#include <span>

#include "cullhull/constrained.hpp"
#include "cullhull/error.hpp"
#include "cullhull/triangulation_io.hpp"
#include "io/file_formats.hpp"
#include "io/formats/geometry_text.hpp"
#include "io/source.hpp"
#include "io/write/mesh.hpp"
#include "io/write/output_text.hpp"

namespace cullhull::internal {
namespace {

[[noreturn]] void refuse(const std::string& f, const std::string& holds, std::uint32_t dimension) {
  throw Error(ErrorCode::invalid_argument, ".", f, " holds ", holds, ", and these are ", dimension,
              "D",
              (dimension == 3 && holds.starts_with("triangles") ? "; .vtk holds tetrahedra" : ""));
}

void refuse_heights(const std::string& f) {
  throw Error(ErrorCode::invalid_argument, ".", f,
              " holds no heights; .ply .obj .off .stl .glb .vtp .vtk .json do");
}

/// The plane's points at their heights, row after row. Throws unless there is one for each.
std::vector<double> lift(const PointView& points, std::span<const double> heights) {
  if (points.dimension != 2)
    throw Error(ErrorCode::invalid_argument, "heights are of 2D points, and these are ",
                points.dimension, "D");
  if (heights.size() != points.count)
    throw Error(ErrorCode::invalid_argument, heights.size(), " heights for ", points.count,
                " points");
  std::vector<double> rows;
  rows.reserve(3 * heights.size());
  for (std::uint64_t i = 0; i < points.count; ++i) {
    if (!std::isfinite(heights[i]))
      throw Error(ErrorCode::not_finite, "the height of point ", i, " is NaN or infinite");
    rows.insert(rows.end(), {points.at(i, 0), points.at(i, 1), heights[i]});
  }
  return rows;
}

/// Rows of indices, each row on a line; a flat list if `width` is 0. `none` is written as -1.
template <class Items>
void indices(JsonWriter& w, const char* name, const Items& items, std::uint64_t width,
             std::uint32_t none = no_index) {
  const auto list = [&](JsonWriter& row, std::uint64_t from, std::uint64_t to) {
    row.list_by(items, from, to, [&](std::uint32_t v) { row.index(v, none); });
  };
  if (width == 0) {
    w.key(name);
    return list(w, 0, items.size());
  }
  w.rows(name, items.size() / width,
         [&](JsonWriter& row, std::uint64_t i) { list(row, i * width, (i + 1) * width); });
}

/// Lists of vertices between offsets, each on a line; the one at infinity becomes -1.
void vertex_lists(JsonWriter& w, const char* name, const Lists<std::uint32_t>& lists) {
  w.rows(name, lists.size(), [&](JsonWriter& row, std::uint64_t i) {
    row.list_by(lists.items, lists.offsets[i], lists.offsets[i + 1],
                [&](std::uint32_t v) { row.index(v, at_infinity); });
  });
}

void write_triangulation_json(const std::string& path, const Triangulation& t,
                              std::span<const double> heights) {
  OutputText out(path);
  out.json("triangulation", {t.point_count, t.dimension, t.scalar}, [&](JsonWriter& w) {
    w.member("affine_dimension", t.affine_dimension);
    w.member("furthest_site", t.furthest_site);
    w.flat("axes", t.axes);
    indices(w, "cells", t.cells, t.corners());
    indices(w, "neighbours", t.neighbours, t.corners());
    indices(w, "cell_groups", t.cell_groups, 0);
    indices(w, "hull_facets", t.hull_facets, t.corners() > 1 ? t.corners() - 1 : 0);
    indices(w, "hull_cells", t.hull_cells, 0);
    w.rows("duplicates", t.duplicates.size(), [&](JsonWriter& row, std::uint64_t i) {
      const std::uint32_t pair[] = {t.duplicates[i].id, t.duplicates[i].representative};
      row.list(pair, 0, 2);
    });
    indices(w, "hidden", t.hidden, 0);
    if (!heights.empty()) w.flat("heights", heights);
  });
  out.commit();
}

HullMesh mesh_of(const PointView& points, const Triangulation& t) {
  HullMesh mesh;
  for (std::uint64_t i = 0; i < points.count; ++i)
    for (std::uint32_t j = 0; j < 3; ++j)
      mesh.coordinates.push_back(j < points.dimension ? points.at(i, j) : 0.0);
  for (std::uint64_t c = 0; c < t.size(); ++c) {
    for (const std::uint32_t v : t.cell(c)) {
      mesh.polygons.items.push_back(v);
      mesh.triangles.push_back(v);
    }
    mesh.polygons.offsets.push_back(3 * (c + 1));
  }
  mesh.edges = (t.cells.size() + t.hull_facet_count()) / 2;
  return mesh;
}

/// Rows of vertices: the outline of a polygon in the plane, then its holes.
using Rings = std::vector<std::vector<std::uint32_t>>;

/// Whether a simple ring, counter-clockwise, has no dent.
bool is_convex(const ClippedCells& cells, const std::vector<std::uint32_t>& ring) {
  const std::size_t n = ring.size();
  const auto side = [&](std::size_t i, unsigned j) {
    return cells.vertices[2 * ring[(i + 1) % n] + j] - cells.vertices[2 * ring[i % n] + j];
  };
  for (std::size_t i = 0; i < n; ++i)
    if (side(i, 0) * side(i + 1, 1) < side(i, 1) * side(i + 1, 0)) return false;
  return true;
}

/// The triangles of a polygon with dents or holes. None where rounded rings cross.
std::vector<std::uint32_t> triangles_of(const ClippedCells& cells, const Rings& rings) {
  std::vector<std::uint32_t> rows, edges;
  std::vector<double> corners;
  for (const auto& ring : rings) {
    const auto first = static_cast<std::uint32_t>(rows.size());
    for (std::uint32_t i = 0; i < ring.size(); ++i) {
      rows.push_back(ring[i]);
      for (unsigned j = 0; j < 2; ++j) corners.push_back(cells.vertices[2 * ring[i] + j]);
      edges.push_back(first + i);
      edges.push_back(first + (i + 1 < ring.size() ? i + 1 : 0));
    }
  }
  ConstrainedOptions options;
  options.threads = 1;  // polygons are many and small
  options.inside_only = true;
  std::vector<std::uint32_t> triangles;
  try {
    const auto found =
        constrained_delaunay(PointView::row_major(corners.data(), rows.size(), 2), edges, options);
    if (found.triangulation.affine_dimension == 2)
      for (const std::uint32_t v : found.triangulation.cells) triangles.push_back(rows[v]);
  } catch (const Error& error) {
    if (error.code() != ErrorCode::invalid_argument) throw;
  }
  return triangles;
}

/// The faces of cells; of the plane the cells themselves.
HullMesh mesh_of(const ClippedCells& cells, bool triangles) {
  HullMesh mesh;
  const unsigned d = cells.dimension;
  for (std::size_t v = 0; v < cells.vertices.size() / d; ++v)
    for (unsigned j = 0; j < 3; ++j)
      mesh.coordinates.push_back(j < d ? cells.vertices[v * d + j] : 0.0);
  const auto add = [&](const std::vector<std::uint32_t>& polygon) {
    if (polygon.size() < 3) return;
    mesh.polygons.items.insert(mesh.polygons.items.end(), polygon.begin(), polygon.end());
    mesh.polygons.offsets.push_back(mesh.polygons.items.size());
    for (std::size_t i = 2; i < polygon.size(); ++i)
      for (const std::size_t at : {std::size_t{0}, i - 1, i}) mesh.triangles.push_back(polygon[at]);
    mesh.edges += polygon.size();
  };
  std::vector<std::uint32_t> polygon;
  for (std::uint64_t i = 0; i < cells.point_count; ++i) {
    const auto first = static_cast<std::uint32_t>(cells.vertex_offsets[i]);
    if (d == 2) {
      for (std::uint64_t g = cells.polygon_offsets[i]; g < cells.polygon_offsets[i + 1]; ++g) {
        Rings rings;
        for (std::uint64_t r = cells.polygon_rings[g]; r < cells.polygon_rings[g + 1]; ++r) {
          rings.emplace_back(cells.ring_starts[r + 1] - cells.ring_starts[r]);
          std::iota(rings.back().begin(), rings.back().end(),
                    static_cast<std::uint32_t>(cells.ring_starts[r]));
        }
        if (rings.size() > 1 && !triangles)
          throw Error(ErrorCode::invalid_argument, "the cell of point ", i,
                      " has a hole, which no polygon of a mesh has; triangles, .geojson and .wkt "
                      "can hold it");
        if (!triangles || (rings.size() == 1 && is_convex(cells, rings[0]))) {
          add(rings[0]);
          continue;
        }
        const std::vector<std::uint32_t> parts = triangles_of(cells, rings);
        if (parts.empty()) add(rings[0]);
        for (std::size_t t = 0; t < parts.size(); t += 3)
          add({parts.begin() + static_cast<std::ptrdiff_t>(t),
               parts.begin() + static_cast<std::ptrdiff_t>(t) + 3});
      }
      continue;
    }
    for (std::uint64_t face = cells.face_offsets[i]; face < cells.face_offsets[i + 1]; ++face) {
      polygon.clear();
      for (const std::uint32_t v : cells.faces[face]) polygon.push_back(first + v);
      add(polygon);
    }
  }
  if (triangles) triangulate(mesh);
  return mesh;
}

}  // namespace

}  // namespace cullhull::internal

namespace cullhull {

using namespace internal;

void check_triangulation_format(const std::string& path, std::uint32_t dimension, bool cells,
                                bool heights) {
  const std::string f = output_format(path, "", "json");
  if (is_mesh(f) && (!cells || holds(f, {OutputKind::cells}))) {
    if (dimension != 2 && (dimension != 3 || !cells))
      refuse(f, cells ? "cells of 2D and 3D points" : "triangles of 2D points", dimension);
  } else if (is_map(f)) {
    if (heights) refuse_heights(f);
    if (dimension != 2) refuse(f, "polygons of 2D points", dimension);
  } else if (f == "vtk" && !cells) {
    if (dimension > 3) refuse(f, "cells of points of up to 3 dimensions", dimension);
  } else if (f != "json") {
    if (cells) refuse_format(path, f, {OutputKind::voronoi, OutputKind::cells});
    refuse_format(path, f, {OutputKind::triangulation});
  }
}

void write_triangulation(const std::string& path, const PointView& points, const Triangulation& t,
                         const std::string& format, std::span<const double> heights,
                         const MapExtras& extras) {
  require_triangulation_of(points, t);
  const std::string f = output_format(path, format, "json");
  if (!heights.empty() && is_map(f)) refuse_heights(f);
  std::vector<double> rows;
  PointView places = points;  // with heights, where there are some
  if (!heights.empty()) {
    rows = lift(points, heights);
    places = PointView::row_major(rows.data(), points.count, 3);
  }
  if (f == "json") return write_triangulation_json(path, t, heights);
  if (f == "vtk") {
    if (t.dimension > 3) refuse(f, "cells of points of up to 3 dimensions", t.dimension);
    std::vector<std::uint32_t> all(t.size());
    std::iota(all.begin(), all.end(), 0U);
    return write_vtk(path, places, t, all);
  }
  if (!is_mesh(f) && !is_map(f)) refuse_format(path, f, {OutputKind::triangulation});
  if (t.dimension != 2) refuse(f, "triangles of 2D points", t.dimension);
  const bool triangles = t.affine_dimension == 2;  // else there are none
  if (!is_map(f)) return write_mesh(path, f, triangles ? mesh_of(places, t) : HullMesh());
  const std::uint64_t count = triangles ? t.size() : 0;
  const MapExtras of_cells =
      columns_of_shapes(extras, count, [&](const PointColumn& column, std::uint64_t c) {
        return value_in_common(column, 3, [&](std::uint64_t i) { return t.cell(c)[i]; });
      });
  write_map(path, f, count, "cell", of_cells,
            [&](std::uint64_t c) { return PlanePolygons{{ring_of(points, t.cell(c))}}; });
}

void write_cells(const std::string& path, const ClippedCells& cells, const std::string& format,
                 Faces faces, const MapExtras& extras) {
  const std::string f = output_format(path, format, "geojson");
  if (!holds(f, {OutputKind::cells})) refuse_format(path, f, {OutputKind::cells});
  if (cells.dimension != 2 && (cells.dimension != 3 || is_map(f)))
    refuse(f, is_map(f) ? "polygons of 2D points" : "cells of 2D and 3D points", cells.dimension);
  if (cells.vertex_offsets.empty())
    throw Error(ErrorCode::invalid_argument, "the cells have no shapes to write");
  if (is_mesh(f)) return write_mesh(path, f, mesh_of(cells, in_triangles(faces, f)));
  write_map(path, f, cells.point_count, "point", extras, [&](std::uint64_t i) {
    PlanePolygons polygons;
    for (std::uint64_t g = cells.polygon_offsets[i]; g < cells.polygon_offsets[i + 1]; ++g) {
      polygons.emplace_back();
      for (std::uint64_t r = cells.polygon_rings[g]; r < cells.polygon_rings[g + 1]; ++r)
        polygons.back().emplace_back(cells.vertices.data() + 2 * cells.ring_starts[r],
                                     cells.vertices.data() + 2 * cells.ring_starts[r + 1]);
    }
    return polygons;
  });
}

void write_voronoi(const std::string& path, const Voronoi& v, const std::string& format) {
  const std::string f = output_format(path, format, "json");
  if (f != "json") refuse_format(path, f, {OutputKind::voronoi});
  OutputText out(path);
  out.json("voronoi", {v.point_count, v.dimension, v.scalar}, [&](JsonWriter& w) {
    w.member("affine_dimension", v.affine_dimension);
    w.member("furthest_site", v.furthest_site);
    w.nested("vertices", v.vertices, v.dimension);
    w.nested("ridge_points", v.ridge_points, 2);
    vertex_lists(w, "ridge_vertices", v.ridges);
    vertex_lists(w, "regions", v.regions);
    w.flat("ray_vertices", v.ray_vertices);
    w.nested("ray_directions", v.ray_directions, v.dimension);
  });
  out.commit();
}

// ---------------------------------------------------------------------------- as Qhull prints

const std::vector<std::string>& delaunay_formats() {
  static const std::vector<std::string> words{"i", "Fn", "Fx", "p"};
  return words;
}

const std::vector<std::string>& voronoi_formats() {
  static const std::vector<std::string> words{"p", "o", "Fv"};
  return words;
}

namespace {

void refuse_word(std::string_view what, const std::vector<std::string>& known) {
  std::string words;
  for (const std::string& word : known) words += (words.empty() ? "" : " ") + word;
  throw Error(ErrorCode::invalid_argument, "unknown format ", quoted_text(std::string(what)),
              "; expected ", words);
}

void add_line(std::string& out, std::uint64_t v) {
  append_number(out, v);
  out += '\n';
}

/// With the places of the rows' ends.
template <class Row>
void add_line_of(std::string& out, const Row& row) {
  bool first = true;
  for (const auto v : row) {
    if (!first) out += ' ';
    first = false;
    if constexpr (std::is_floating_point_v<std::remove_cvref_t<decltype(v)>>)
      append_number(out, v);
    else if (v == no_index)
      out += "-1";
    else
      append_number(out, std::uint64_t{v});
  }
  out += '\n';
}

}  // namespace

std::string triangulation_to_qhull_text(const PointView& points, const Triangulation& t,
                                        std::string_view what) {
  std::string out;
  if (what == "i" || what == "Fn") {
    add_line(out, t.size());
    for (std::uint64_t c = 0; c < t.size(); ++c) {
      if (what == "Fn") out += std::to_string(t.corners()) + ' ';
      add_line_of(out, what == "i" ? t.cell(c) : t.neighbours_of(c));
    }
  } else if (what == "Fx") {
    std::vector<std::uint32_t> ids(t.hull_facets.begin(), t.hull_facets.end());
    std::sort(ids.begin(), ids.end());
    ids.erase(std::unique(ids.begin(), ids.end()), ids.end());
    add_line(out, ids.size());
    for (const std::uint32_t id : ids) add_line(out, id);
  } else if (what == "p") {
    add_line(out, t.dimension);
    add_line(out, points.count);
    for (std::uint64_t i = 0; i < points.count; ++i) {
      std::vector<double> row;
      for (std::uint32_t j = 0; j < points.dimension; ++j) row.push_back(points.at(i, j));
      add_line_of(out, row);
    }
  } else {
    refuse_word(what, delaunay_formats());
  }
  return out;
}

std::string voronoi_to_qhull_text(const Voronoi& v, std::string_view what) {
  std::string out;
  const auto add_vertices = [&] {
    for (std::uint64_t i = 0; i < v.vertex_count(); ++i)
      add_line_of(out, std::span<const double>(v.vertices.data() + i * v.dimension, v.dimension));
  };
  // Vertices count from 1: 0 is the one at infinity.
  const auto add_list = [&](std::span<const std::uint32_t> list) {
    for (const std::uint32_t g : list) out += ' ' + std::to_string(g == at_infinity ? 0 : g + 1);
    out += '\n';
  };
  if (what == "p") {
    add_line(out, v.dimension);
    add_line(out, v.vertex_count());
    add_vertices();
  } else if (what == "o") {
    add_line(out, v.dimension);
    out += std::to_string(v.vertex_count() + 1) + ' ' + std::to_string(v.point_count) + " 1\n";
    add_line_of(out, std::vector<double>(v.dimension, -10.101));  // as Qhull has infinity
    add_vertices();
    for (std::uint64_t i = 0; i < v.point_count; ++i) {
      out += std::to_string(v.region(i).size());
      add_list(v.region(i));
    }
  } else if (what == "Fv") {
    add_line(out, v.ridge_count());
    for (std::uint64_t i = 0; i < v.ridge_count(); ++i) {
      const auto list = v.ridge(i);
      out += std::to_string(list.size() + 2);
      for (unsigned j = 0; j < 2; ++j) out += ' ' + std::to_string(v.ridge_points[2 * i + j]);
      add_list(list);
    }
  } else {
    refuse_word(what, voronoi_formats());
  }
  return out;
}

}  // namespace cullhull
