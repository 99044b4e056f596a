// Queries of a hull, for arrays of points.
#include "cullhull/query.hpp"

#include <nanobind/nanobind.h>
#include <nanobind/stl/tuple.h>

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

// ------------------------------------ one answer a point, of the host's memory or of a device's

/// A question: the type of an answer in HullQuery and in the array, and how it is asked.
#define CULLHULL_QUESTION(name, Item, Shown, method)                                         \
  struct name {                                                                              \
    using item = Item;                                                                       \
    using shown = Shown;                                                                     \
    template <class View>                                                                    \
    static void ask(const HullQuery& query, const View& view, Item* out, const Options& o) { \
      query.method(view, out, o);                                                            \
    }                                                                                        \
    static void leave(const HullQuery& query, const DevicePointView& view, Item* out,        \
                      const Options& o) {                                                    \
      query.method##_on_device(view, out, o);                                                \
    }                                                                                        \
  }
CULLHULL_QUESTION(Contains, std::uint8_t, bool, contains);
CULLHULL_QUESTION(Sides, Side, std::int8_t, sides);
CULLHULL_QUESTION(Distances, double, double, signed_distances);
CULLHULL_QUESTION(Supports, std::uint64_t, std::int64_t, supports);
#undef CULLHULL_QUESTION

template <class Q>
Array<typename Q::shown> answers(const Solid& solid, nb::handle array, const Settings* settings) {
  const Points points(array);
  Output<typename Q::item> out(points.view().count);
  ask_all(solid, points.view(), settings,
          [&](const HullQuery& query, const PointView& view, const Options& options) {
    Q::ask(query, view, out.data(), options);
  });
  return std::move(out).template to_array<typename Q::shown>();
}

/// Of points in a device's memory.
template <class Q>
Array<typename Q::shown> answers_there(const Solid& solid, const DevicePoints& points,
                                       const Settings* settings) {
  Output<typename Q::item> out(points.view.count);
  run(settings, Length::long_,
      [&](const Options& options) { Q::ask(solid.query(), points.view, out.data(), options); });
  return std::move(out).template to_array<typename Q::shown>();
}

/// And the answers stay there.
template <class Q>
DeviceItems answers_on_device(const Solid& solid, const DevicePoints& points,
                              const Settings* settings) {
  using Item = typename Q::item;
  static_assert(sizeof(Item) == sizeof(typename Q::shown));
  cullhull::DeviceMemory memory;
  run(settings, Length::long_, [&](const Options& options) {
    const HullQuery& query = solid.query();
    memory = cullhull::device_memory(points.view, points.view.count * sizeof(Item));
    Q::leave(query, points.view, static_cast<Item*>(memory.data.get()), options);
  });
  const void* const data = memory.data.get();
  return {data,
          {points.view.count},
          nb::dtype<typename Q::shown>(),
          memory.device,
          freed_without_gil(std::move(memory.data))};
}

template <class Q>
void bind_question(nb::class_<Solid>& c, const std::string& name) {
  const auto settings = nb::arg("settings").none();
  c.def(name.c_str(), answers<Q>, nb::arg("points"), settings)
      .def((name + "_there").c_str(), answers_there<Q>, nb::arg("points"), settings)
      .def((name + "_on_device").c_str(), answers_on_device<Q>, nb::arg("points"), settings);
}

// ---------------------------------------------------------------------------- answers of parts

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

Array<std::int64_t> visible_facets(const Solid& solid, nb::handle array, const Settings* settings) {
  const Points points(array);
  std::vector<std::uint32_t> visible;
  ask_all(solid, points.view(), settings,
          [&](const HullQuery& query, const PointView& view, const Options&) {
    std::vector<double> point(view.dimension);
    for (std::uint32_t j = 0; j < view.dimension; ++j) point[j] = view.at(0, j);
    visible = query.visible_facets(point.data());
  });
  return copied<std::int64_t>(visible);
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
    return facet == cullhull::no_index ? std::int64_t{-1} : std::int64_t{facet};
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

}  // namespace

void bind_query(nb::class_<Solid>& c) {
  bind_question<Contains>(c, "contains");
  bind_question<Sides>(c, "sides");
  bind_question<Distances>(c, "distances");
  bind_question<Supports>(c, "supports");
  const auto settings = nb::arg("settings").none();
  c.def("nearest_facets", nearest_facets, nb::arg("points"), settings)
      .def("visible_facets", visible_facets, nb::arg("points"), settings)
      .def("rays", rays, nb::arg("origins"), nb::arg("directions"), settings);
}

}  // namespace binding
