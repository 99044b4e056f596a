// Queries of a hull, for arrays of points.
#include "cullhull/query.hpp"

#include <nanobind/nanobind.h>
#include <nanobind/stl/tuple.h>

#include <optional>
#include <string>
#include <tuple>
#include <vector>

#include "arrays.hpp"
#include "cullhull/error.hpp"
#include "device_items.hpp"
#include "device_points.hpp"
#include "points.hpp"
#include "solid.hpp"

namespace binding {

using cullhull::DevicePointView;
using cullhull::HullQuery;
using cullhull::NearestFacet;
using cullhull::Options;
using cullhull::PointView;
using cullhull::RayHit;
using cullhull::Side;

namespace {

void require_same_dimension(const Solid& solid, const PointView& points) {
  if (points.dimension != solid.hull().dimension)
    throw cullhull::Error(cullhull::ErrorCode::invalid_argument,
                          "the hull has dimension " + std::to_string(solid.hull().dimension) +
                              ", what is asked about has " + std::to_string(points.dimension));
}

/// The first question prepares for all. From 5D on an answer climbs over many facets.
Length length_of_questions(const Solid& solid, const PointView& view) {
  if (!solid.is_prepared()) return length_of(view, solid.hull().simplex_count());
  if (view.dimension > 4) return view.count <= 1'000 ? Length::moderate : Length::long_;
  return view.count <= 100       ? Length::brief
         : view.count <= 100'000 ? Length::moderate
                                 : Length::long_;
}

/// Calls ask(query, view, options) under run().
template <class Ask>
void ask_all(const Solid& solid, const PointView& view, const Settings* settings, Ask&& ask) {
  require_same_dimension(solid, view);
  run(settings, length_of_questions(solid, view),
      [&](const Options& options) { ask(solid.query(), view, options); });
}

Array<bool> contains(const Solid& solid, nb::handle array, const Settings* settings) {
  const Points points(array);
  Output<std::uint8_t> out(points.view().count);
  ask_all(solid, points.view(), settings,
          [&](const HullQuery& query, const PointView& view, const Options& options) {
    query.contains(view, out.data(), options);
  });
  return std::move(out).to_array<bool>();
}

Array<std::int8_t> sides(const Solid& solid, nb::handle array, const Settings* settings) {
  const Points points(array);
  Output<std::int8_t> out(points.view().count);
  ask_all(solid, points.view(), settings,
          [&](const HullQuery& query, const PointView& view, const Options& options) {
    query.sides(view, reinterpret_cast<Side*>(out.data()), options);
  });
  return std::move(out).to_array();
}

Array<double> distances(const Solid& solid, nb::handle array, const Settings* settings) {
  const Points points(array);
  Output<double> out(points.view().count);
  ask_all(solid, points.view(), settings,
          [&](const HullQuery& query, const PointView& view, const Options& options) {
    query.signed_distances(view, out.data(), options);
  });
  return std::move(out).to_array();
}

std::tuple<Array<std::int64_t>, Array<double>> nearest_facets(const Solid& solid, nb::handle array,
                                                              const Settings* settings) {
  const Points points(array);
  const std::size_t n = points.view().count;
  Output<std::int64_t> facets(n);
  Output<double> distance(n);
  ask_all(solid, points.view(), settings,
          [&](const HullQuery& query, const PointView& view, const Options& options) {
    std::vector<NearestFacet> nearest(n);
    query.nearest_facets(view, nearest.data(), options);
    for (std::size_t i = 0; i < n; ++i) {
      facets.data()[i] = nearest[i].facet;
      distance.data()[i] = nearest[i].distance;
    }
  });
  return std::make_tuple(std::move(facets).to_array(), std::move(distance).to_array());
}

Array<std::int64_t> supports(const Solid& solid, nb::handle array, const Settings* settings) {
  const Points directions(array);
  Output<std::int64_t> out(directions.view().count);
  ask_all(solid, directions.view(), settings,
          [&](const HullQuery& query, const PointView& view, const Options& options) {
    query.supports(view, reinterpret_cast<std::uint64_t*>(out.data()), options);
  });
  return std::move(out).to_array();
}

Array<std::int64_t> visible_facets(const Solid& solid, nb::handle array, const Settings* settings) {
  const Points points(array);
  std::vector<std::uint32_t> visible;
  ask_all(solid, points.view(), settings,
          [&](const HullQuery& query, const PointView& view, const Options&) {
    std::vector<double> point(view.dimension);
    for (std::uint32_t j = 0; j < view.dimension; ++j) point[j] = view.at(0, j);
    visible = query.visible_facets(point.data());
  });
  Output<std::int64_t> out(visible.size());
  std::copy(visible.begin(), visible.end(), out.data());
  return std::move(out).to_array();
}

/// (hit, enter, exit, enter_facet, exit_facet), one array each; no facet is -1.
using Rays =
    std::tuple<Array<bool>, Array<double>, Array<double>, Array<std::int64_t>, Array<std::int64_t>>;
Rays rays(const Solid& solid, nb::handle origin_array, nb::handle direction_array,
          const Settings* settings) {
  const Points origins(origin_array), directions(direction_array);
  require_same_dimension(solid, directions.view());
  if (origins.view().count != directions.view().count)
    throw cullhull::Error(cullhull::ErrorCode::invalid_argument,
                          "as many origins as directions are needed");
  const std::size_t n = origins.view().count;
  Output<std::uint8_t> hit(n);
  Output<double> enter(n), exit(n);
  Output<std::int64_t> enter_facet(n), exit_facet(n);
  const auto number = [](std::uint32_t facet) {
    return facet == RayHit::no_facet ? std::int64_t{-1} : std::int64_t{facet};
  };
  ask_all(solid, origins.view(), settings,
          [&](const HullQuery& query, const PointView& view, const Options& options) {
    std::vector<RayHit> hits(n);
    query.rays(view, directions.view(), hits.data(), options);
    for (std::size_t i = 0; i < n; ++i) {
      hit.data()[i] = hits[i].hit;
      enter.data()[i] = hits[i].enter;
      exit.data()[i] = hits[i].exit;
      enter_facet.data()[i] = number(hits[i].enter_facet);
      exit_facet.data()[i] = number(hits[i].exit_facet);
    }
  });
  return Rays(std::move(hit).to_array<bool>(), std::move(enter).to_array(),
              std::move(exit).to_array(), std::move(enter_facet).to_array(),
              std::move(exit_facet).to_array());
}

// ---------------------------------------------------------------- points in a device's memory

/// The same as ask_all.
template <class Ask>
void ask_there(const Solid& solid, const DevicePoints& points, const Settings* settings,
               const Ask& ask) {
  run(settings, Length::long_,
      [&](const Options& options) { ask(solid.query(), points.view, options); });
}

Array<bool> contains_there(const Solid& solid, const DevicePoints& points,
                           const Settings* settings) {
  Output<std::uint8_t> out(points.view.count);
  ask_there(solid, points, settings,
            [&](const HullQuery& query, const DevicePointView& view, const Options& options) {
    query.contains(view, out.data(), options);
  });
  return std::move(out).to_array<bool>();
}

Array<std::int8_t> sides_there(const Solid& solid, const DevicePoints& points,
                               const Settings* settings) {
  Output<std::int8_t> out(points.view.count);
  ask_there(solid, points, settings,
            [&](const HullQuery& query, const DevicePointView& view, const Options& options) {
    query.sides(view, reinterpret_cast<Side*>(out.data()), options);
  });
  return std::move(out).to_array();
}

Array<double> distances_there(const Solid& solid, const DevicePoints& points,
                              const Settings* settings) {
  Output<double> out(points.view.count);
  ask_there(solid, points, settings,
            [&](const HullQuery& query, const DevicePointView& view, const Options& options) {
    query.signed_distances(view, out.data(), options);
  });
  return std::move(out).to_array();
}

Array<std::int64_t> supports_there(const Solid& solid, const DevicePoints& directions,
                                   const Settings* settings) {
  Output<std::int64_t> out(directions.view.count);
  ask_there(solid, directions, settings,
            [&](const HullQuery& query, const DevicePointView& view, const Options& options) {
    query.supports(view, reinterpret_cast<std::uint64_t*>(out.data()), options);
  });
  return std::move(out).to_array();
}

// ------------------------------------------------------- and their answers, which stay there

/// `T`: an item in HullQuery; `Shown`: in the array.
template <class T, class Shown, class Ask>
DeviceItems answers_there(const Solid& solid, const DevicePoints& points, const Settings* settings,
                          const Ask& ask) {
  static_assert(sizeof(T) == sizeof(Shown));
  cullhull::DeviceMemory memory;
  ask_there(solid, points, settings,
            [&](const HullQuery& query, const DevicePointView& view, const Options& options) {
    memory = cullhull::device_memory(view, view.count * sizeof(T));
    ask(query, view, static_cast<T*>(memory.data.get()), options);
  });
  const void* const data = memory.data.get();
  return {data,
          {points.view.count},
          nb::dtype<Shown>(),
          memory.device,
          freed_without_gil(std::move(memory.data))};
}

DeviceItems contains_on_device(const Solid& solid, const DevicePoints& points,
                               const Settings* settings) {
  return answers_there<std::uint8_t, bool>(
      solid, points, settings,
      [](const HullQuery& query, const DevicePointView& view, std::uint8_t* out,
         const Options& options) { query.contains_on_device(view, out, options); });
}

DeviceItems sides_on_device(const Solid& solid, const DevicePoints& points,
                            const Settings* settings) {
  return answers_there<Side, std::int8_t>(
      solid, points, settings,
      [](const HullQuery& query, const DevicePointView& view, Side* out, const Options& options) {
    query.sides_on_device(view, out, options);
      });
}

DeviceItems distances_on_device(const Solid& solid, const DevicePoints& points,
                                const Settings* settings) {
  return answers_there<double, double>(
      solid, points, settings,
      [](const HullQuery& query, const DevicePointView& view, double* out, const Options& options) {
    query.signed_distances_on_device(view, out, options);
      });
}

DeviceItems supports_on_device(const Solid& solid, const DevicePoints& directions,
                               const Settings* settings) {
  return answers_there<std::uint64_t, std::int64_t>(
      solid, directions, settings,
      [](const HullQuery& query, const DevicePointView& view, std::uint64_t* out,
         const Options& options) { query.supports_on_device(view, out, options); });
}

}  // namespace

void bind_query(nb::class_<Solid>& c) {
  c.def("contains", contains, nb::arg("points"), nb::arg("settings").none())
      .def("sides", sides, nb::arg("points"), nb::arg("settings").none())
      .def("distances", distances, nb::arg("points"), nb::arg("settings").none())
      .def("nearest_facets", nearest_facets, nb::arg("points"), nb::arg("settings").none())
      .def("supports", supports, nb::arg("directions"), nb::arg("settings").none())
      .def("contains_there", contains_there, nb::arg("points"), nb::arg("settings").none())
      .def("sides_there", sides_there, nb::arg("points"), nb::arg("settings").none())
      .def("distances_there", distances_there, nb::arg("points"), nb::arg("settings").none())
      .def("supports_there", supports_there, nb::arg("directions"), nb::arg("settings").none())
      .def("contains_on_device", contains_on_device, nb::arg("points"), nb::arg("settings").none())
      .def("sides_on_device", sides_on_device, nb::arg("points"), nb::arg("settings").none())
      .def("distances_on_device", distances_on_device, nb::arg("points"),
           nb::arg("settings").none())
      .def("supports_on_device", supports_on_device, nb::arg("directions"),
           nb::arg("settings").none())
      .def("visible_facets", visible_facets, nb::arg("points"), nb::arg("settings").none())
      .def("rays", rays, nb::arg("origins"), nb::arg("directions"), nb::arg("settings").none());
}

}  // namespace binding
