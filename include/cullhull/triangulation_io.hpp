// Writing triangulations and Voronoi diagrams. docs/formats.md, "Output: triangulations, Voronoi
// diagrams, alpha shapes", describes every format.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "cullhull/alpha_shape.hpp"
#include "cullhull/io.hpp"
#include "cullhull/point_view.hpp"
#include "cullhull/triangulation.hpp"
#include "cullhull/voronoi.hpp"

#pragma GCC visibility push(default)
namespace cullhull {

/// Writes the cells in the format of the extension of `path` or `format`: .ply .obj .off .stl .glb
/// .vtp (triangles of 2D points), .vtk (cells of any triangulation of up to 3 dimensions), .geojson
/// .wkt (triangles of 2D points) or .json (everything except statistics). `heights`: empty, or one
/// number per 2D point: its third coordinate in meshes and .vtk (default 0) and the list `heights`
/// of .json, so that a terrain surface keeps its heights. The bytes depend only on points, heights
/// and triangulation; the file appears complete or not at all, as with write_hull. Throws
/// Error{invalid_argument} if the format cannot hold the triangulation or the heights, or if these
/// are not one finite number per point; Error{io}.
void write_triangulation(const std::string& path, const PointView& points,
                         const Triangulation& triangulation, const std::string& format = "",
                         std::span<const double> heights = {}, const MapExtras& extras = {});

/// Writes the polygons of clipped cells (in 3D their faces): .ply .obj .off .vtp, and in 2D
/// .geojson and .wkt, one or several polygons per point, with holes. `faces`: whether a mesh holds
/// polygons or triangles. Polygons of a mesh have no holes: Error{invalid_argument} for cells that
/// have. The columns of `extras` go into .geojson. Files and errors as above.
void write_cells(const std::string& path, const ClippedCells& cells, const std::string& format = "",
                 Faces faces = Faces::by_format, const MapExtras& extras = {});

/// Writes the diagram as .json. File and errors as above.
void write_voronoi(const std::string& path, const Voronoi& voronoi, const std::string& format = "");

/// Writes a shape of alpha_shape(points, triangulation, alpha): its boundary as .ply .obj .off .stl
/// .glb .vtp (in 3D; of 2D points its triangles) or as polygons with holes, one for each connected
/// part (lines of points on a line, a point of equal ones), .geojson .wkt (2D); its cells as .vtk
/// (up to 3 dimensions); everything as .json. `alpha`: NaN for a shape of concave_hull, which has
/// no alpha (null in .json).
void write_alpha_shape(const std::string& path, const PointView& points,
                       const Triangulation& triangulation, const AlphaShape& shape, double alpha,
                       const std::string& format = "", const MapExtras& extras = {});
/// Throws, before the work, what write_alpha_shape would throw for this name.
void check_alpha_shape_format(const std::string& path, std::uint32_t dimension);

/// Throws, before the work, what the writers would throw for this name: write_cells if `cells`,
/// else write_triangulation, with `heights` or without.
void check_triangulation_format(const std::string& path, std::uint32_t dimension, bool cells,
                                bool heights = false);

/// Polygons, or lines: ring i is the corners [ring_offsets[i], ring_offsets[i + 1]).
struct Polygons {
  std::vector<double> corners;  ///< corners x 2
  std::vector<std::uint64_t> ring_offsets{0};
  /// A view for clip_voronoi; valid as long as this object.
  PointView points() const { return PointView::row_major(corners, 2); }
};

/// Reads the lines of a GeoJSON file as read_polygons does: LineString, MultiLineString, and the
/// rings of polygons, whose first corner is then the last again. Skips points. Each line is a ring
/// of the result.
Polygons read_lines(const std::string& path);

/// Reads all polygons of a GeoJSON file, also .gz and .zst (`-`: standard input): Polygon,
/// MultiPolygon, collections of them, and features. Skips points, lines and third coordinates.
/// Throws Error{bad_file} for other content or a file without polygons, Error{io}.
Polygons read_polygons(const std::string& path);

/// Text as Qhull's `qdelaunay` prints it; `what` is i (cells), Fn (neighbours, -1 at the hull), Fx
/// (points of the hull) or p (all points). Throws Error{invalid_argument} for other words.
std::string triangulation_to_qhull_text(const PointView& points, const Triangulation& triangulation,
                                        std::string_view what);
/// Text as `qvoronoi` prints it; `what` is p (vertices), o (vertices and regions) or Fv (ridges).
std::string voronoi_to_qhull_text(const Voronoi& voronoi, std::string_view what);

/// The words that these functions accept.
const std::vector<std::string>& delaunay_formats();
const std::vector<std::string>& voronoi_formats();

}  // namespace cullhull
#pragma GCC visibility pop
