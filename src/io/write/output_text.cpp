#include "io/write/output_text.hpp"

#include <algorithm>

#include "cullhull/error.hpp"

namespace cullhull::internal {

void require_triangulation_of(const PointView& points, const Triangulation& t) {
  const auto exist = [&](const Array<std::uint32_t>& ids) {
    return std::all_of(ids.begin(), ids.end(), [&](std::uint32_t v) { return v < t.point_count; });
  };
  const std::size_t m = t.corners();
  if (points.count != t.point_count || points.dimension != t.dimension || t.affine_dimension < -1 ||
      m > t.dimension + std::size_t{1} || t.cells.size() != t.size() * m ||
      t.neighbours.size() != t.cells.size() || t.axes.size() + (m == 0 ? 0 : 1) != m ||
      std::any_of(t.axes.begin(), t.axes.end(),
                  [&](std::uint32_t a) { return a >= t.dimension; }) ||
      t.hull_facets.size() != t.hull_cells.size() * (m == 0 ? 0 : m - 1) || !exist(t.cells) ||
      !exist(t.hull_facets))
    throw Error(ErrorCode::invalid_argument, "the triangulation is not that of these points");
}

void write_vtk(const std::string& path, const PointView& points, const Triangulation& t,
               std::span<const std::uint32_t> cells) {
  static constexpr const char* kinds[] = {"", "1\n", "3\n", "5\n", "10\n"};
  OutputText out(path);
  out.add(
      "# vtk DataFile Version 3.0\ncullhull triangulation\nASCII\n"
      "DATASET UNSTRUCTURED_GRID\nPOINTS ");
  out.number(points.count).add(" double\n");
  for (std::uint64_t i = 0; i < points.count; ++i)
    for (std::uint32_t j = 0; j < 3; ++j)
      out.number(j < points.dimension ? points.at(i, j) : 0.0).add(j < 2 ? " " : "\n");
  const std::uint64_t m = t.corners();
  out.add("CELLS ").number(std::uint64_t{cells.size()}).add(" ");
  out.number(cells.size() * (m + 1)).add("\n");
  for (const std::uint32_t c : cells) {
    out.number(m);
    for (const std::uint32_t v : t.cell(c)) out.add(" ").number(std::uint64_t{v});
    out.add("\n");
  }
  out.add("CELL_TYPES ").number(std::uint64_t{cells.size()}).add("\n");
  for (std::size_t i = 0; i < cells.size(); ++i) out.add(kinds[m]);
  out.commit();
}

void write_mesh(const std::string& path, const std::string& f, const HullMesh& mesh) {
  OutputFile out(path);
  if (f == "ply") write_ply(out, mesh);
  if (f == "obj") write_obj(out, mesh);
  if (f == "off") write_off(out, mesh);
  if (f == "stl") write_stl(out, mesh);
  if (f == "glb") write_glb(out, mesh);
  if (f == "vtp") write_vtp(out, mesh);
  out.commit();
}

}  // namespace cullhull::internal
