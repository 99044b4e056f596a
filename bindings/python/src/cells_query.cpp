// Questions to a triangulation, one array of them at a time.
#include <nanobind/stl/string.h>

#include <string>

#include "arrays.hpp"
#include "cullhull/error.hpp"
#include "triangulation.hpp"

namespace binding {

using cullhull::Options;
using cullhull::PointView;
using cullhull::TriangulationQuery;

const TriangulationQuery& Cells::query(const Options& options) const {
  std::call_once(prepared_, [&] {
    query_ =
        std::make_unique<TriangulationQuery>(points_.view(), triangulation_, weights_, options);
  });
  return *query_;
}

namespace {

void require_same_dimension(const Cells& cells, const PointView& points) {
  if (points.dimension != cells.triangulation().dimension)
    throw cullhull::Error(cullhull::ErrorCode::invalid_argument,
                          "the triangulation has dimension " +
                              std::to_string(cells.triangulation().dimension) +
                              ", what is asked about has " + std::to_string(points.dimension));
}

/// Calls ask(query, view, options) under run().
template <class Ask>
void ask_all(const Cells& cells, const PointView& view, const Settings* settings, Ask&& ask) {
  require_same_dimension(cells, view);
  run(settings, length_of(view, cells.triangulation().size()),
      [&](const Options& options) { ask(cells.query(options), view, options); });
}

Array<std::int32_t> find(const Cells& cells, nb::handle array, const Settings* settings) {
  const Points points(array);
  check_numbers(cells.triangulation().size());
  Output<std::uint32_t> out(points.view().count);
  ask_all(cells, points.view(), settings,
          [&](const TriangulationQuery& query, const PointView& view, const Options& options) {
    query.find(view, out.data(), options);
  });
  return std::move(out).to_array<std::int32_t>();
}

Array<std::int32_t> nearest(const Cells& cells, nb::handle array, const Settings* settings) {
  const Points points(array);
  check_numbers(cells.triangulation().point_count);
  Output<std::uint32_t> out(points.view().count);
  ask_all(cells, points.view(), settings,
          [&](const TriangulationQuery& query, const PointView& view, const Options& options) {
    query.nearest(view, out.data(), options);
  });
  return std::move(out).to_array<std::int32_t>();
}

/// One after another, k + 1 a point. `found`: cells, or -1.
Array<double> barycentric(const Cells& cells, nb::handle array, Array<std::int32_t> found,
                          const Settings* settings) {
  const Points points(array);
  const std::size_t count = points.view().count, corners = cells.triangulation().corners();
  const auto all = static_cast<std::int64_t>(cells.triangulation().size());
  if (!found.is_list() || found.size() != count) throw nb::value_error("a cell for each point");
  for (std::size_t i = 0; i < count; ++i)
    if (found.data()[i] < -1 || found.data()[i] >= all)
      throw cullhull::Error(cullhull::ErrorCode::invalid_argument,
                            "there is no cell " + std::to_string(found.data()[i]));
  Output<double> out(count * corners);
  ask_all(cells, points.view(), settings,
          [&](const TriangulationQuery& query, const PointView& view, const Options& options) {
    query.barycentric(view, reinterpret_cast<const std::uint32_t*>(found.data()), out.data(),
                      options);
  });
  return std::move(out).to_array();
}

}  // namespace

void bind_cells_query(nb::class_<Cells>& c) {
  c.def("find", find, nb::arg("points"), nb::arg("settings").none())
      .def("nearest", nearest, nb::arg("points"), nb::arg("settings").none())
      .def("barycentric", barycentric, nb::arg("points"), nb::arg("cells"),
           nb::arg("settings").none());
}

}  // namespace binding
