// Delaunay and regular triangulations.
#include "triangulation.hpp"

#include <nanobind/stl/string.h>
#include <nanobind/stl/unique_ptr.h>

#include <memory>
#include <string>
#include <utility>

#include "arrays.hpp"
#include "solid.hpp"
#include "statistics.hpp"

namespace binding {

using cullhull::Certificate;
using cullhull::Options;
using cullhull::Triangulation;
using cullhull::TriangulationOptions;

Cells::Cells(Triangulation triangulation, nb::object points, nb::object weights)
    : triangulation_(std::move(triangulation)),
      points_array_(std::move(points)),
      weights_array_(std::move(weights)),
      points_(points_array_),
      weights_(weights_of(weights_array_)) {}

Length length_of_cells(const Cells& cells) noexcept {
  const std::uint64_t n = cells.triangulation().size();
  return n <= 200 ? Length::brief : n <= 20'000 ? Length::moderate : Length::long_;
}

std::vector<double> weights_of(nb::handle array) {
  if (array.is_none()) return {};
  auto list = nb::cast<Array<double>>(array);
  if (!list.is_list()) throw nb::type_error("weights must lie one after another");
  return {list.data(), list.data() + list.size()};
}

namespace {

using Self = CellsHandle;

/// Some microseconds a point in low dimensions, many times that in high ones.
Length length_of_triangulation(const cullhull::PointView& points) noexcept {
  const std::uint32_t d = points.dimension;
  const std::uint64_t brief = d <= 2 ? 200 : d == 3 ? 50 : 0;
  const std::uint64_t moderate = d <= 2 ? 20'000 : d == 3 ? 5'000 : d == 4 ? 500 : d <= 8 ? 20 : 0;
  if (points.count <= brief) return Length::brief;
  return points.count <= moderate ? Length::moderate : Length::long_;
}

std::unique_ptr<Cells> triangulate(nb::object array, nb::object weights, bool furthest_site,
                                   const Settings* settings) {
  const Points points(array);
  const std::vector<double> heights = weights_of(weights);
  const bool weighted = !weights.is_none();
  auto result = computed(settings, length_of_triangulation(points.view()), [&](const Options& o) {
    auto chosen = cullhull::options_as<TriangulationOptions>(o);
    chosen.furthest_site = furthest_site;
    return weighted ? cullhull::regular_triangulation(points.view(), heights, chosen)
                    : cullhull::delaunay(points.view(), chosen);
  });
  return std::make_unique<Cells>(std::move(result), std::move(array), std::move(weights));
}

Certificate certify(const Cells& cells, const Settings* settings) {
  const cullhull::PointView& points = cells.points().view();
  return computed(settings, length_of_triangulation(points), [&](const Options& options) {
    const auto chosen = cullhull::options_as<TriangulationOptions>(options);
    return cells.weights_array().is_none()
               ? cullhull::certify(points, cells.triangulation(), chosen)
               : cullhull::certify(points, cells.weights(), cells.triangulation(), chosen);
  });
}

/// Its numbers fit into int32.
const Triangulation& shown(Self self) {
  const Triangulation& t = cells_in(self).triangulation();
  check_numbers(t.point_count);
  check_numbers(t.size());
  return t;
}

Array<std::int32_t> cell_groups(Self self) {
  const Triangulation& t = shown(self);
  if (!t.cell_groups.empty()) return list_in(t.cell_groups, self);
  Array<std::int32_t> all = Array<std::int32_t>::make({t.size()});
  for (std::size_t i = 0; i < t.size(); ++i) all.data()[i] = static_cast<std::int32_t>(i);
  return std::move(all).lock();
}

Array<std::int32_t> duplicates(Self self) {
  const Triangulation& t = shown(self);
  static_assert(sizeof(cullhull::DuplicatePoint) == 2 * sizeof(std::uint32_t));
  return rows_of(reinterpret_cast<const std::int32_t*>(t.duplicates.data()), t.duplicates.size(), 2,
                 self);
}

}  // namespace

void bind_triangulation(nb::module_& m) {
  nb::class_<Cells> c(m, "Cells", "A triangulation: cullhull.Triangulation wraps it.");
  c.def_prop_ro("points", [](const Cells& s) { return s.points_array(); });
  c.def_prop_ro("weights", [](const Cells& s) { return s.weights_array(); });
  const auto number = [&](const char* name, auto of) {
    c.def_prop_ro(name, [of](const Cells& s) { return of(s.triangulation()); });
  };
  number("dimension", [](const Triangulation& t) { return t.dimension; });
  number("point_count", [](const Triangulation& t) { return t.point_count; });
  number("scalar", [](const Triangulation& t) { return cullhull::scalar_name(t.scalar); });
  number("affine_dimension", [](const Triangulation& t) { return t.affine_dimension; });
  number("furthest_site", [](const Triangulation& t) { return t.furthest_site; });
  number("cell_count", [](const Triangulation& t) { return t.size(); });
  number("vertex_count", [](const Triangulation& t) { return t.vertex_count(); });
  number("statistics", [](const Triangulation& t) { return dict_of(t.statistics); });
  c.def_prop_ro("axes", [](Self self) { return list_in(shown(self).axes, self); });
  c.def_prop_ro("cells",
                [](Self self) { return rows_in(shown(self).cells, shown(self).corners(), self); });
  c.def_prop_ro("neighbours", [](Self self) {
    return rows_in(shown(self).neighbours, shown(self).corners(), self);
  });
  c.def_prop_ro("cell_groups", cell_groups);
  c.def_prop_ro("hull_facets", [](Self self) {
    const unsigned corners = shown(self).corners();
    return rows_in(shown(self).hull_facets, corners == 0 ? 0 : corners - 1, self);
  });
  c.def_prop_ro("hull_cells", [](Self self) { return list_in(shown(self).hull_cells, self); });
  c.def_prop_ro("duplicates", duplicates);
  c.def_prop_ro("hidden", [](Self self) { return list_in(shown(self).hidden, self); });
  bind_cells_query(m, c);
  bind_lifted(m, c);
  m.def("triangulate", triangulate, nb::arg("points"), nb::arg("weights").none(),
        nb::arg("furthest_site"), nb::arg("settings").none());
  m.def("certify_cells", certify, nb::arg("cells"), nb::arg("settings").none());
}

}  // namespace binding
