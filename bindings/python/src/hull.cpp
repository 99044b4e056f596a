// convex_hull, cull, certify and the result's arrays.
#include <nanobind/nanobind.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/unique_ptr.h>

#include <algorithm>
#include <memory>
#include <optional>
#include <tuple>

#include "arrays.hpp"
#include "cullhull/certify.hpp"
#include "cullhull/cull.hpp"
#include "cullhull/generate.hpp"
#include "cullhull/io.hpp"
#include "points.hpp"
#include "solid.hpp"
#include "statistics.hpp"

namespace binding {

using cullhull::Certificate;
using cullhull::Hull;
using cullhull::Options;

namespace {

std::unique_ptr<Solid> convex_hull(nb::handle array, const Settings* settings) {
  const Points points(array);
  return computed(settings, length_of_hull(points.view()), [&](const Options& options) {
    return std::make_unique<Solid>(cullhull::convex_hull(points.view(), options), points.view());
  });
}

Array<std::int64_t> cull(nb::handle array, const Settings* settings) {
  const Points points(array);
  return computed(
             settings, length_of_hull(points.view()),
             [&](const Options& options) {
    return kept_ids(cullhull::cull(points.view(), options), points.view().count);
             })
      .to_array();
}

Certificate certify(nb::handle array, const Solid& solid, const Settings* settings) {
  const Points points(array);
  return computed(settings, length_of(points.view()), [&](const Options& options) {
    return cullhull::certify(points.view(), solid.hull(), options);
  });
}

Array<double> generate(const std::string& shape, std::uint64_t count, std::uint32_t dimension,
                       std::uint64_t seed) {
  constexpr std::uint64_t brief = 100'000, step = 1 << 22;
  const bool few = dimension > 0 && count < brief / dimension;
  return computed(
             nullptr, few ? Length::brief : Length::long_,
             [&](const Options& options) {
    const std::vector<double> points =
        cullhull::generate(shape, count, dimension, seed, options.stop);
    Output<double> out(points.size());
    for (std::size_t i = 0; i < points.size() && !options.stop.stop_requested(); i += step)
      std::copy_n(points.data() + i, std::min<std::size_t>(step, points.size() - i),
                  out.data() + i);
    return out;
             })
      .to_array();
}

nb::typed<nb::dict, nb::str, nb::str> shapes() {
  nb::typed<nb::dict, nb::str, nb::str> all;
  for (const cullhull::Shape& shape : cullhull::shapes()) all[shape.name] = shape.description;
  return all;
}

/// The hull of a .json file, which holds the coordinates of its vertices.
std::unique_ptr<Solid> load_hull(const std::string& path) {
  std::vector<double> rows;
  Hull hull = computed(nullptr, Length::long_, [&](const Options& options) {
    return cullhull::hull_from_json(path, &rows, options);
  });
  if (rows.size() != hull.vertices.size() * hull.dimension)
    throw cullhull::Error(cullhull::ErrorCode::bad_file, path,
                          ": the hull has no vertex_coordinates, as other programs write it");
  return std::make_unique<Solid>(std::move(hull), std::move(rows));
}

/// Writes a file of `solid` and the points `array`, or, for None, its own vertices, renumbered.
void save(const std::string& path, const Solid& solid, nb::handle array, const std::string& format,
          std::optional<bool> polygons, const std::string& crs) {
  const cullhull::Faces faces = faces_of(polygons);
  const cullhull::MapExtras extras{crs, {}};
  if (!array.is_none()) {
    const Points points(array);
    const nb::gil_scoped_release release;
    cullhull::write_hull(path, points.view(), solid.hull(), format, faces, extras);
    return;
  }
  const nb::gil_scoped_release release;
  const std::vector<double> rows = solid.rows_by_place();
  const Hull hull = solid.by_place();
  cullhull::write_hull(
      path, cullhull::PointView::row_major(rows.data(), hull.point_count, hull.dimension), hull,
      format, faces, extras);
}

/// The same hull, of points among which another one, which does not affect the hull, has this id.
std::unique_ptr<Solid> skipping(const Solid& solid, std::uint64_t id) {
  Hull hull = solid.hull();
  hull.rename([id](std::uint64_t v) { return v >= id ? v + 1 : v; });
  ++hull.point_count;
  return std::make_unique<Solid>(std::move(hull), solid.vertex_rows());
}

using Self = SolidHandle;

auto parts_of(const Certificate& c) {
  return std::tie(c.valid, c.reason, c.ridges_checked, c.points_checked, c.exact_decisions);
}

constexpr const char* certificate_text = R"(What `certify` found: true if the hull is proven.

Attributes
----------
valid : bool
reason : str
    The first thing wrong; empty if valid.
ridges_checked, points_checked, exact_decisions : int

Examples
--------
>>> import cullhull
>>> points = cullhull.generate("ball", 100)
>>> found = cullhull.certify(points, cullhull.convex_hull(points))
>>> bool(found), found.reason, found.points_checked
(True, '', 100)
)";

void bind_arrays(nb::class_<Solid>& c) {
  c.def_prop_ro("vertices", [](Self self) { return list_in(hull_in(self).vertices, self); });
  c.def_prop_ro("vertex_points", [](Self self) {
    return rows_in(nb::inst_ptr<Solid>(self)->vertex_rows(), hull_in(self).dimension, self);
  });
  c.def_prop_ro("facet_offsets",
                [](Self self) { return list_in(hull_in(self).facets.offsets, self); });
  c.def_prop_ro("facet_vertices",
                [](Self self) { return list_in(hull_in(self).facets.items, self); });
  c.def_prop_ro("facet_neighbour_offsets",
                [](Self self) { return list_in(hull_in(self).facet_neighbours.offsets, self); });
  c.def_prop_ro("facet_neighbours", [](Self self) {
    check_numbers(hull_in(self).facet_count());
    return list_in(hull_in(self).facet_neighbours.items, self);
  });
  c.def_prop_ro("facet_planes", [](Self self) {
    return rows_in(hull_in(self).facet_planes, std::size_t{hull_in(self).dimension} + 1, self);
  });
  c.def_prop_ro("simplices", [](Self self) {
    const Hull& h = hull_in(self);
    return rows_of(shown_data(h.simplices), h.simplex_count(), simplex_width(h), self);
  });
  c.def_prop_ro("simplex_neighbours", [](Self self) {
    const Hull& h = hull_in(self);
    check_numbers(h.simplex_count());
    return rows_of(shown_data(h.simplex_neighbours), h.simplex_count(), simplex_width(h), self);
  });
  c.def_prop_ro("simplex_facets", [](Self self) {
    check_numbers(hull_in(self).facet_count());
    return list_in(hull_in(self).simplex_facets, self);
  });
  c.def_prop_ro("centroid", [](Self self) { return list_in(hull_in(self).centroid, self); });
}

}  // namespace

void bind_hull(nb::module_& m) {
  nb::class_<Solid> c(m, "Solid", "A hull: cullhull.Hull wraps it.");
  const auto number = [&](const char* name, auto of) {
    c.def_prop_ro(name, [of](const Solid& s) { return of(s.hull()); });
  };
  number("dimension", [](const Hull& h) { return h.dimension; });
  number("point_count", [](const Hull& h) { return h.point_count; });
  number("scalar", [](const Hull& h) { return cullhull::scalar_name(h.scalar); });
  number("affine_dimension", [](const Hull& h) { return h.affine_dimension; });
  number("facet_count", [](const Hull& h) { return h.facet_count(); });
  number("simplex_count", [](const Hull& h) { return h.simplex_count(); });
  number("volume", [](const Hull& h) { return h.volume; });
  number("area", [](const Hull& h) { return h.area; });
  number("statistics", [](const Hull& h) { return dict_of(h.statistics); });
  c.def("skipping", skipping, nb::arg("id"));
  bind_arrays(c);
  bind_query(c);
  bind_drop_in(c);

  nb::class_<Certificate>(m, "Certificate", certificate_text)
      .def(
          "__init__",
          [](Certificate* self, bool valid, std::string reason, std::uint64_t ridges,
             std::uint64_t points, std::uint64_t exact) {
    new (self) Certificate{valid, std::move(reason), ridges, points, exact};
          },
          nb::arg("valid"), nb::arg("reason"), nb::arg("ridges_checked"), nb::arg("points_checked"),
          nb::arg("exact_decisions"))
      .def_ro("valid", &Certificate::valid)
      .def_ro("reason", &Certificate::reason)
      .def_ro("ridges_checked", &Certificate::ridges_checked)
      .def_ro("points_checked", &Certificate::points_checked)
      .def_ro("exact_decisions", &Certificate::exact_decisions)
      .def(
          "__reduce__",
          [](nb::handle self) {
    return nb::make_tuple(
        self.type(),
        nb::make_tuple(self.attr("valid"), self.attr("reason"), self.attr("ridges_checked"),
                       self.attr("points_checked"), self.attr("exact_decisions")));
          },
          nb::sig("def __reduce__(self) -> tuple[typing.Any, ...]"))
      .def("__bool__", [](const Certificate& found) { return found.valid; })
      .def(
          "__eq__",
          [](const Certificate& found, nb::handle other) {
    return nb::isinstance<Certificate>(other) &&
           parts_of(found) == parts_of(nb::cast<const Certificate&>(other));
          },
          nb::arg("other").none(), nb::sig("def __eq__(self, other: object, /) -> bool"))
      .def(
          "__hash__",
          [](const Certificate& found) {
    return static_cast<Py_hash_t>(2 * found.points_checked + (found.valid ? 1 : 0));
          })
      .def("__repr__", [](const Certificate& found) {
        return found.valid ? std::string("<Certificate: valid>")
                           : "<Certificate: not valid: " + found.reason + ">";
      });

  m.def("convex_hull", convex_hull, nb::arg("points"), nb::arg("settings").none());
  m.def("cull", cull, nb::arg("points"), nb::arg("settings").none());
  m.def("certify", certify, nb::arg("points"), nb::arg("solid"), nb::arg("settings").none());
  m.def("generate", generate, nb::arg("shape"), nb::arg("count"), nb::arg("dimension"),
        nb::arg("seed"));
  m.def("shapes", shapes);
  m.def("load_hull", load_hull, nb::arg("path"));
  m.def("save", save, nb::arg("path"), nb::arg("solid"), nb::arg("points").none(),
        nb::arg("format"), nb::arg("polygons").none(), nb::arg("crs") = "");
}

}  // namespace binding
