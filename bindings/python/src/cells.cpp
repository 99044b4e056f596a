// What is made of triangulations: alpha shapes, graphs, constrained edges, natural neighbours.
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/unique_ptr.h>

#include <algorithm>
#include <memory>
#include <string>
#include <tuple>
#include <type_traits>
#include <utility>
#include <vector>

#include "arrays.hpp"
#include "cullhull/alpha_shape.hpp"
#include "cullhull/constrained.hpp"
#include "cullhull/error.hpp"
#include "cullhull/interpolate.hpp"
#include "cullhull/proximity_graphs.hpp"
#include "solid.hpp"
#include "triangulation.hpp"

namespace binding {

using cullhull::Interpolator;
using cullhull::Options;
using cullhull::Triangulation;

namespace {

std::vector<std::uint32_t> numbers_of(Array<std::int32_t> list, const char* what) {
  if (!list.is_list()) throw nb::value_error("numbers must lie one after another");
  std::vector<std::uint32_t> numbers;
  for (std::size_t i = 0; i < list.size(); ++i) {
    if (list.data()[i] < 0)
      throw cullhull::Error(
          cullhull::ErrorCode::invalid_argument,
          std::string("there is no ") + what + " " + std::to_string(list.data()[i]));
    numbers.push_back(static_cast<std::uint32_t>(list.data()[i]));
  }
  return numbers;
}

using Numbers = Array<std::int32_t>;
using Offsets = Array<std::int64_t>;

// -------------------------------------------------------------------------------- alpha shapes

std::tuple<Numbers, Numbers, Numbers> alpha_shape(const Cells& cells, double alpha,
                                                  const Settings* settings) {
  const auto shape = computed(settings, length_of_cells(cells), [&](const Options& options) {
    return cullhull::alpha_shape(cells.points().view(), cells.triangulation(), alpha, options);
  });
  return {kept(shape.cells), kept(shape.facets), kept(shape.facet_cells)};
}

Array<double> alpha_radii(const Cells& cells, const Settings* settings) {
  return kept(computed(settings, length_of_cells(cells), [&](const Options& options) {
    return cullhull::alpha_radii(cells.points().view(), cells.triangulation(), options);
  }));
}

/// By a length, or with `ratio` by a share of the lengths; the length, too.
std::tuple<double, Numbers, Numbers, Numbers> concave_hull(const Cells& cells, double number,
                                                           bool ratio, const Settings* settings) {
  double length = number;
  const auto hull = computed(settings, length_of_cells(cells), [&](const Options& options) {
    const auto points = cells.points().view();
    if (ratio) length = cullhull::concave_length(points, cells.triangulation(), number, options);
    return cullhull::concave_hull(points, cells.triangulation(), length, options);
  });
  return {length, kept(hull.cells), kept(hull.facets), kept(hull.facet_cells)};
}

double critical_alpha(const Cells& cells, bool one_region, const Settings* settings) {
  return computed(settings, length_of_cells(cells), [&](const Options& options) {
    return cullhull::critical_alpha(cells.points().view(), cells.triangulation(), one_region,
                                    options);
  });
}

std::tuple<Numbers, Offsets, Offsets> cell_polygons(const Cells& cells, Numbers chosen,
                                                    const Settings* settings) {
  const std::vector<std::uint32_t> numbers = numbers_of(std::move(chosen), "cell");
  const auto polygons = computed(settings, length_of_cells(cells), [&](const Options& options) {
    return cullhull::cell_polygons(cells.points().view(), cells.triangulation(), numbers, options);
  });
  return {kept(polygons.rings.items), kept(polygons.rings.offsets), kept(polygons.polygon_offsets)};
}

// -------------------------------------------------------------------------------------- graphs

using GraphOf = cullhull::Array<std::uint32_t> (*)(const cullhull::PointView&, const Triangulation&,
                                                   const cullhull::RunOptions&);

template <GraphOf graph_of>
Numbers graph(const Cells& cells, const Settings* settings) {
  return kept(computed(settings, length_of_cells(cells), [&](const Options& options) {
    return graph_of(cells.points().view(), cells.triangulation(), options);
  }));
}

// --------------------------------------------------------------------------- constrained edges

std::tuple<std::unique_ptr<Cells>, Numbers, Numbers, Numbers, cullhull::Certificate> constrained(
    nb::object array, Numbers edges, bool inside_only, bool certified, const Settings* settings) {
  const Points points(array);
  const std::vector<std::uint32_t> pairs = numbers_of(std::move(edges), "point");
  cullhull::ConstrainedTriangulation result;
  cullhull::Certificate certificate;
  run(settings, points.view().count < 100 ? Length::brief : Length::long_,
      [&](const Options& options) {
    auto chosen = cullhull::options_as<cullhull::ConstrainedOptions>(options);
    chosen.inside_only = inside_only;
    result = cullhull::constrained_delaunay(points.view(), pairs, chosen);
    if (certified) certificate = cullhull::certify(points.view(), pairs, result, chosen);
  });
  check_numbers(result.triangulation.size());
  Numbers pieces = kept(result.pieces), sources = kept(result.piece_sources),
          depths = kept(result.depths);
  return {std::make_unique<Cells>(std::move(result.triangulation), std::move(array), nb::none()),
          std::move(pieces), std::move(sources), std::move(depths), std::move(certificate)};
}

// -------------------------------------------------------------------------- natural neighbours

std::unique_ptr<Interpolator> interpolator(const Cells& cells, Array<double> values,
                                           std::uint32_t components, const Settings* settings) {
  if (!values.is_list() || values.size() != cells.triangulation().point_count * components)
    throw nb::value_error("a value for each point");
  if (!cells.weights_array().is_none())
    throw cullhull::Error(cullhull::ErrorCode::invalid_argument,
                          "interpolation needs a triangulation without weights");
  return computed(settings, length_of_cells(cells), [&](const Options& options) {
    return std::make_unique<Interpolator>(cells.points().view(), cells.triangulation(),
                                          values.data(), components, options);
  });
}

Array<double> natural(const Interpolator& of, nb::handle array, double outside,
                      const Settings* settings) {
  const Points points(array);
  Output<double> out(points.view().count * of.components());
  run(settings, points.view().count < 10 ? Length::brief : Length::long_,
      [&](const Options& options) { of.natural(points.view(), out.data(), outside, options); });
  return std::move(out).to_array();
}

std::tuple<Numbers, Array<double>> natural_neighbours(const Interpolator& of, Array<double> point) {
  const cullhull::NaturalNeighbours found = of.natural_neighbours(point.data());
  return {kept(found.ids), kept(found.weights)};
}

}  // namespace

void bind_cells(nb::module_& m) {
  const auto cells = nb::arg("cells");
  const auto settings = nb::arg("settings").none();
  m.def("alpha_shape", alpha_shape, cells, nb::arg("alpha"), settings);
  m.def("alpha_radii", alpha_radii, cells, settings);
  m.def("concave_hull", concave_hull, cells, nb::arg("number"), nb::arg("ratio"), settings);
  m.def("critical_alpha", critical_alpha, cells, nb::arg("one_region"), settings);
  m.def("cell_polygons", cell_polygons, cells, nb::arg("chosen"), settings);
  m.def("minimum_spanning_tree", graph<cullhull::minimum_spanning_tree>, cells, settings);
  m.def("gabriel_graph", graph<cullhull::gabriel_graph>, cells, settings);
  m.def("relative_neighbourhood_graph", graph<cullhull::relative_neighbourhood_graph>, cells,
        settings);
  m.def("constrained", constrained, nb::arg("points"), nb::arg("edges"), nb::arg("inside_only"),
        nb::arg("certified"), settings);
  nb::class_<Interpolator>(m, "Interpolator", "Values at the vertices of a triangulation.")
      .def("natural", natural, nb::arg("points"), nb::arg("outside"), settings)
      .def("natural_neighbours", natural_neighbours, nb::arg("point"));
  m.def("interpolator", interpolator, cells, nb::arg("values"), nb::arg("components"), settings);
}

}  // namespace binding
