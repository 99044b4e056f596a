// Intersections of halfspaces.
#include "cullhull/halfspaces.hpp"

#include <nanobind/nanobind.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/unique_ptr.h>

#include <memory>
#include <tuple>
#include <vector>

#include "arrays.hpp"
#include "points.hpp"
#include "solid.hpp"

namespace binding {

using cullhull::HalfspaceIntersection;
using cullhull::Options;

namespace {

/// (interior_point, dual_points, dual, bounded, vertices)
using Intersection =
    std::tuple<Array<double>, Array<double>, std::unique_ptr<Solid>, bool, Array<double>>;

/// `interior`: None or one row.
Intersection intersect(nb::handle array, nb::handle interior, const Settings* settings) {
  const Points halfspaces(array);
  std::vector<double> centre;
  if (!interior.is_none()) {
    const Points row(interior);
    for (std::uint32_t j = 0; j < row.view().dimension; ++j) centre.push_back(row.view().at(0, j));
  }
  std::unique_ptr<HalfspaceIntersection> result;
  std::unique_ptr<Solid> dual;
  run(settings, length_of(halfspaces.view()), [&](const Options& options) {
    result = std::make_unique<HalfspaceIntersection>(cullhull::intersect_halfspaces(
        halfspaces.view(), interior.is_none() ? nullptr : centre.data(), options));
    dual = std::make_unique<Solid>(
        std::move(result->dual),
        cullhull::PointView::row_major(result->dual_points.data(), halfspaces.view().count,
                                       result->dimension));
  });
  const std::size_t d = result->dimension, facets = dual->hull().facet_count();
  const bool bounded = result->bounded;
  HalfspaceIntersection* const raw = result.release();
  const nb::capsule owner(raw,
                          [](void* p) noexcept { delete static_cast<HalfspaceIntersection*>(p); });
  return Intersection(list_of(raw->interior_point.data(), d, owner),
                      rows_of(raw->dual_points.data(), raw->dual_points.size() / d, d, owner),
                      std::move(dual), bounded, rows_of(raw->vertices.data(), facets, d, owner));
}

}  // namespace

void bind_halfspaces(nb::module_& m) {
  m.def("intersect_halfspaces", intersect, nb::arg("halfspaces"), nb::arg("interior_point").none(),
        nb::arg("settings").none());
}

}  // namespace binding
