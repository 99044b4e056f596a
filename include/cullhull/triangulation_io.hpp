// Writing triangulations and Voronoi diagrams. docs/formats.md, "Triangulations", describes every
// format.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "cullhull/alpha_shape.hpp"
#include "cullhull/point_view.hpp"
#include "cullhull/triangulation.hpp"
#include "cullhull/voronoi.hpp"

#pragma GCC visibility push(default)
namespace cullhull::inline v1 {

/// Writes the cells in the format of the extension of `path` or `format`: .ply .obj .off .stl .glb
/// .vtp (triangles of 2D points), .vtk (cells of any triangulation of up to 3 dimensions),
/// .geojson .wkt (triangles of 2D points) or .json (everything but statistics). `heights`: empty,
/// or for 2D points one number each, the third coordinates in meshes and .vtk (0 if empty) and the
/// list `heights` of .json: so a terrain surface keeps its heights. The bytes depend on points,
/// heights and triangulation alone; the file appears whole or not at all, as write_hull's does.
/// Throws Error{invalid_argument} if the format cannot hold the triangulation or the heights, or
/// these are not one finite number a point; Error{io}.
void write_triangulation(const std::string& path, const PointView& points,
                         const Triangulation& triangulation, const std::string& format = "",
                         std::span<const double> heights = {});

/// Likewise the polygons of clipped cells (in space their faces): .ply .obj .off .vtp, and in 2D
/// .geojson and .wkt, a polygon for each point, or several, with holes. Meshes have no holes:
/// Error{invalid_argument} for cells that have.
void write_cells(const std::string& path, const ClippedCells& cells,
                 const std::string& format = "");

/// Likewise the diagram as .json.
void write_voronoi(const std::string& path, const Voronoi& voronoi, const std::string& format = "");

/// Likewise the shape of alpha_shape(points, triangulation, alpha): its boundary as .ply .obj .off
/// .stl .glb .vtp (in 3D; of 2D points its triangles) or as polygons with holes, one for each
/// piece, .geojson .wkt (2D); its cells as .vtk (up to 3 dimensions); everything as .json. `alpha`:
/// NaN for a shape of concave_hull, which has no alpha (null in .json).
void write_alpha_shape(const std::string& path, const PointView& points,
                       const Triangulation& triangulation, const AlphaShape& shape, double alpha,
                       const std::string& format = "");
/// Throws what it would throw for a name, before the work.
void check_alpha_shape_format(const std::string& path, std::uint32_t dimension);

/// Throws what the writers would throw for a name, before the work: for a diagram's cells or, with
/// `cells` false, for a triangulation, perhaps with heights.
void check_triangulation_format(const std::string& path, std::uint32_t dimension, bool cells,
                                bool heights = false);

/// Polygons that own their corners.
struct Polygons {
  std::vector<double> corners;  ///< corners x 2
  std::vector<std::uint64_t> ring_offsets{0};
  /// For clip_voronoi; valid as long as this is.
  PolygonRings rings() const;
};

/// All polygons of a GeoJSON file, also .gz and .zst (`-`: standard input): Polygon, MultiPolygon,
/// collections of them, and features; points and lines beside them are left out, and so are third
/// coordinates. Throws Error{bad_file} for what is no GeoJSON or has no polygon, Error{io}.
Polygons read_polygons(const std::string& path);

/// Text as Qhull's `qdelaunay` prints it, `what` being i (cells), Fn (neighbours, -1 at the hull),
/// Fx (points of the hull) or p (all points). Throws Error{invalid_argument} for other words.
std::string triangulation_to_qhull_text(const PointView& points, const Triangulation& triangulation,
                                        std::string_view what);
/// As `qvoronoi`: p (vertices), o (vertices and regions), Fv (ridges).
std::string voronoi_to_qhull_text(const Voronoi& voronoi, std::string_view what);

/// The words they know.
const std::vector<std::string>& delaunay_formats();
const std::vector<std::string>& voronoi_formats();

}  // namespace cullhull::inline v1
#pragma GCC visibility pop
