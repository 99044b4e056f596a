// Delaunay and regular triangulations.
#include "triangulation.hpp"

#include <nanobind/stl/string.h>
#include <nanobind/stl/unique_ptr.h>

#include <memory>
#include <string>
#include <utility>

#include "arrays.hpp"
#include "solid.hpp"

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

const Triangulation& shown(Self self) { return cells_in(self).triangulation(); }

/// int32, with -1 for no_index: fewer than 2^31 points and cells have numbers that fit.
template <class Numbers>
Array<std::int32_t> number_rows(const Numbers& numbers, std::size_t width, Self self) {
  const Triangulation& t = shown(self);
  check_numbers(t.point_count);
  check_numbers(t.size());
  return rows_of(reinterpret_cast<const std::int32_t*>(numbers.data()),
                 width == 0 ? 0 : numbers.size() / width, width, self);
}
template <class Numbers>
Array<std::int32_t> number_list(const Numbers& numbers, Self self) {
  const Triangulation& t = shown(self);
  check_numbers(t.point_count);
  check_numbers(t.size());
  return list_of(reinterpret_cast<const std::int32_t*>(numbers.data()), numbers.size(), self);
}

Array<std::int32_t> cell_groups(Self self) {
  const Triangulation& t = shown(self);
  if (!t.cell_groups.empty()) return number_list(t.cell_groups, self);
  check_numbers(t.size());
  Array<std::int32_t> all = Array<std::int32_t>::make({t.size()});
  for (std::size_t i = 0; i < t.size(); ++i) all.data()[i] = static_cast<std::int32_t>(i);
  return std::move(all).lock();
}

Array<std::int32_t> duplicates(Self self) {
  const Triangulation& t = shown(self);
  static_assert(sizeof(cullhull::DuplicatePoint) == 2 * sizeof(std::uint32_t));
  check_numbers(t.point_count);
  return rows_of(reinterpret_cast<const std::int32_t*>(t.duplicates.data()), t.duplicates.size(), 2,
                 self);
}

nb::typed<nb::dict, nb::str, nb::any> statistics(const Cells& cells) {
  const cullhull::TriangulationStatistics& s = cells.triangulation().statistics;
  nb::typed<nb::dict, nb::str, nb::any> all;
  all["rung_counts"] = nb::make_tuple(s.rung_counts[0], s.rung_counts[1], s.rung_counts[2]);
  all["ties"] = s.ties;
  all["cells_created"] = s.cells_created;
  all["threads"] = s.threads;
  all["order_seconds"] = s.order_seconds;
  all["insert_seconds"] = s.insert_seconds;
  all["write_seconds"] = s.write_seconds;
  all["compute_seconds"] = s.compute_seconds;
  return all;
}

}  // namespace

void bind_triangulation(nb::module_& m) {
  nb::class_<Cells> c(m, "Cells", "A triangulation: cullhull.Triangulation wraps it.");
  c.def_prop_ro("points", [](const Cells& s) { return s.points_array(); })
      .def_prop_ro("weights", [](const Cells& s) { return s.weights_array(); })
      .def_prop_ro("dimension", [](const Cells& s) { return s.triangulation().dimension; })
      .def_prop_ro("point_count", [](const Cells& s) { return s.triangulation().point_count; })
      .def_prop_ro("scalar",
                   [](const Cells& s) { return cullhull::scalar_name(s.triangulation().scalar); })
      .def_prop_ro("affine_dimension",
                   [](const Cells& s) { return s.triangulation().affine_dimension; })
      .def_prop_ro("furthest_site", [](const Cells& s) { return s.triangulation().furthest_site; })
      .def_prop_ro("cell_count", [](const Cells& s) { return s.triangulation().size(); })
      .def_prop_ro("vertex_count", [](const Cells& s) { return s.triangulation().vertex_count(); })
      .def_prop_ro("statistics", statistics);
  c.def_prop_ro("axes", [](Self self) { return number_list(shown(self).axes, self); })
      .def_prop_ro(
          "cells",
          [](Self self) { return number_rows(shown(self).cells, shown(self).corners(), self); })
      .def_prop_ro(
          "neighbours",
          [](Self self) {
    return number_rows(shown(self).neighbours, shown(self).corners(), self);
          })
      .def_prop_ro("cell_groups", cell_groups)
      .def_prop_ro(
          "hull_facets",
          [](Self self) {
    const unsigned corners = shown(self).corners();
    return number_rows(shown(self).hull_facets, corners == 0 ? 0 : corners - 1, self);
          })
      .def_prop_ro("hull_cells",
                   [](Self self) { return number_list(shown(self).hull_cells, self); })
      .def_prop_ro("duplicates", duplicates)
      .def_prop_ro("hidden", [](Self self) { return number_list(shown(self).hidden, self); });
  bind_cells_query(m, c);
  m.def("triangulate", triangulate, nb::arg("points"), nb::arg("weights").none(),
        nb::arg("furthest_site"), nb::arg("settings").none());
  m.def("certify_cells", certify, nb::arg("cells"), nb::arg("settings").none());
}

}  // namespace binding
