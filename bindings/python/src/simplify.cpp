// Hulls with fewer vertices and fewer planes, within a stated distance.
#include "cullhull/simplify.hpp"

#include <nanobind/nanobind.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/unique_ptr.h>

#include <algorithm>
#include <memory>
#include <tuple>
#include <vector>

#include "arrays.hpp"
#include "solid.hpp"

namespace binding {

using cullhull::Hull;
using cullhull::Options;
using cullhull::PointView;
using cullhull::Simplification;

namespace {

/// The points of a solid: its vertices, numbered by their position.
struct Vertices {
  explicit Vertices(const Solid& solid)
      : hull(solid.by_place()),
        rows(solid.rows_by_place()),
        view(PointView::row_major(rows.data(), hull.point_count, hull.dimension)) {}

  Hull hull;
  std::vector<double> rows;
  PointView view;
};

/// (solid, dropped, distance)
std::tuple<std::unique_ptr<Solid>, std::uint64_t, double> simplify(const Solid& solid,
                                                                   double distance,
                                                                   const Settings* settings) {
  std::unique_ptr<Solid> kept;
  Simplification found;
  run(settings, solid.hull().simplex_count() <= 4000 ? Length::moderate : Length::long_,
      [&](const Options& options) {
    const Vertices vertices(solid);
    found = cullhull::simplify(vertices.view, vertices.hull, distance, options);
    kept = std::make_unique<Solid>(std::move(found.hull), vertices.view);
    kept->renumber(solid);
  });
  return {std::move(kept), found.dropped, found.distance};
}

Array<std::int64_t> shared_planes(const Solid& solid, double distance) {
  std::vector<std::uint32_t> of;
  {
    const nb::gil_scoped_release release;
    const Vertices vertices(solid);
    of = cullhull::shared_planes(vertices.view, vertices.hull, distance);
  }
  return copied<std::int64_t>(of);
}

double rounding_distance(const Solid& solid) {
  const Vertices vertices(solid);
  return cullhull::rounding_distance(vertices.view, vertices.hull);
}

}  // namespace

void bind_simplify(nb::module_& m) {
  m.def("simplify", simplify, nb::arg("solid"), nb::arg("distance"), nb::arg("settings").none());
  m.def("shared_planes", shared_planes, nb::arg("solid"), nb::arg("distance"));
  m.def("rounding_distance", rounding_distance, nb::arg("solid"));
}

}  // namespace binding
