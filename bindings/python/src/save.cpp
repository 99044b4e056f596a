// Files of triangulations, diagrams, clipped cells, alpha shapes and batches of hulls, as the
// program writes them.
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <cstdint>
#include <optional>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "arrays.hpp"
#include "batch.hpp"
#include "cullhull/alpha_shape.hpp"
#include "cullhull/error.hpp"
#include "cullhull/group_hulls.hpp"
#include "cullhull/triangulation_io.hpp"
#include "solid.hpp"
#include "triangulation.hpp"

namespace binding {

namespace {

using Numbers = Array<std::int32_t>;

/// Numbers below `limit`, as the functions that made them returned them.
cullhull::Array<std::uint32_t> copied_back(Numbers numbers, std::uint64_t limit) {
  cullhull::Array<std::uint32_t> list;
  list.reserve(numbers.size());
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    const std::int32_t number = numbers.data()[i];
    if (number < 0 || static_cast<std::uint64_t>(number) >= limit)
      throw cullhull::Error(cullhull::ErrorCode::invalid_argument,
                            "the shape's arrays are not those of its triangulation");
    list.push_back(static_cast<std::uint32_t>(number));
  }
  return list;
}

/// `heights`: None, or a third coordinate for each point of the plane.
void save_cells(const std::string& path, const Cells& cells, nb::handle heights,
                const std::string& format, const std::string& crs) {
  const std::vector<double> rows = weights_of(heights);
  const nb::gil_scoped_release release;
  cullhull::write_triangulation(path, cells.points().view(), cells.triangulation(), format, rows,
                                {crs, {}});
}

void save_diagram(const std::string& path, const cullhull::Voronoi& diagram,
                  const std::string& format) {
  const nb::gil_scoped_release release;
  cullhull::write_voronoi(path, diagram, format);
}

void save_clipped(const std::string& path, const cullhull::ClippedCells& cells,
                  const std::string& format, std::optional<bool> polygons, const std::string& crs) {
  const nb::gil_scoped_release release;
  cullhull::write_cells(path, cells, format, faces_of(polygons), {crs, {}});
}

/// The shape as alpha_shape() or concave_hull() returned it.
cullhull::AlphaShape shape_of(const Cells& cells, Numbers cell_numbers, Numbers facets,
                              Numbers facet_cells) {
  const cullhull::Triangulation& t = cells.triangulation();
  return {copied_back(std::move(cell_numbers), t.size()),
          copied_back(std::move(facets), t.point_count),
          copied_back(std::move(facet_cells), t.size())};
}

/// The measures of the shape and of its boundary.
std::tuple<double, double> shape_measures(const Cells& cells, Numbers cell_numbers, Numbers facets,
                                          Numbers facet_cells) {
  const cullhull::AlphaShape shape =
      shape_of(cells, std::move(cell_numbers), std::move(facets), std::move(facet_cells));
  const nb::gil_scoped_release release;
  const auto found = cullhull::shape_measures(cells.points().view(), cells.triangulation(), shape);
  return {found.volume, found.boundary};
}

/// `alpha` is NaN for a concave hull.
void save_alpha_shape(const std::string& path, const Cells& cells, Numbers cell_numbers,
                      Numbers facets, Numbers facet_cells, double alpha, const std::string& format,
                      const std::string& crs) {
  const cullhull::AlphaShape shape =
      shape_of(cells, std::move(cell_numbers), std::move(facets), std::move(facet_cells));
  const nb::gil_scoped_release release;
  cullhull::write_alpha_shape(path, cells.points().view(), cells.triangulation(), shape, alpha,
                              format, {crs, {}});
}

/// `words`: a key for each hull, as text.
void save_batch(const std::string& path, const Batch& batch, const std::vector<std::string>& words,
                const std::string& key_name, const std::string& format, const std::string& crs) {
  const nb::gil_scoped_release release;
  cullhull::PointKeys keys;
  for (const std::string& word : words) keys.add(word);
  cullhull::write_group_hulls(path, batch.hulls, batch.vertex_rows, keys, key_name, format,
                              {crs, {}});
}

}  // namespace

void bind_save(nb::module_& m) {
  const auto path = nb::arg("path"), format = nb::arg("format"), cells = nb::arg("cells"),
             crs = nb::arg("crs");
  m.def("save_cells", save_cells, path, cells, nb::arg("heights").none(), format, crs);
  m.def("save_diagram", save_diagram, path, nb::arg("diagram"), format);
  m.def("save_clipped", save_clipped, path, cells, format, nb::arg("polygons").none(), crs);
  m.def("save_alpha_shape", save_alpha_shape, path, cells, nb::arg("cell_numbers"),
        nb::arg("facets"), nb::arg("facet_cells"), nb::arg("alpha"), format, crs);
  m.def("shape_measures", shape_measures, cells, nb::arg("cell_numbers"), nb::arg("facets"),
        nb::arg("facet_cells"));
  m.def("save_batch", save_batch, path, nb::arg("batch"), nb::arg("keys"), nb::arg("key_name"),
        format, crs);
}

}  // namespace binding
