// A hull of 2D or 3D points as the polygon mesh that .ply .obj .off .stl hold.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "cullhull/hull_fwd.hpp"
#include "cullhull/io.hpp"
#include "io/coordinates.hpp"
#include "io/write/output_file.hpp"

namespace cullhull::internal {

/// Only the hull's vertices, in the order of hull.vertices; z = 0 for points of the plane.
struct HullMesh {
  std::vector<double> coordinates;       ///< x y z of each vertex
  Lists<std::uint32_t> polygons;         ///< counter-clockwise from outside
  std::vector<std::uint32_t> triangles;  ///< the polygons triangulated, 3 each
  std::uint64_t edges = 0;
  std::size_t vertex_count() const { return coordinates.size() / 3; }
};

/// Whether a mesh of this format holds triangles alone.
inline bool in_triangles(Faces faces, std::string_view format) {
  return faces == Faces::triangles || (faces == Faces::by_format && format != "vtp");
}

/// Throws Error{invalid_argument} unless the points are 2D or 3D.
HullMesh make_mesh(const Coordinates& points, const Hull& hull, const std::string& format,
                   Faces faces);

/// Replaces the polygons by the triangles. A polygon of n corners is divided by n - 3 diagonals.
void triangulate(HullMesh& mesh);

void write_ply(OutputFile& out, const HullMesh& mesh);
void write_obj(OutputFile& out, const HullMesh& mesh);
void write_off(OutputFile& out, const HullMesh& mesh);
void write_stl(OutputFile& out, const HullMesh& mesh);
void write_glb(OutputFile& out, const HullMesh& mesh);
void write_vtp(OutputFile& out, const HullMesh& mesh);

/// The shortest decimal that reads back as the same double.
void append_number(std::string& out, double value);
void append_number(std::string& out, std::uint64_t value);

}  // namespace cullhull::internal
