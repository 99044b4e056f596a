// Questions to a triangulation, one array of them at a time.
#include <nanobind/stl/string.h>

#include <algorithm>
#include <limits>
#include <string>
#include <vector>

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
    is_prepared_ = true;
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

/// An answer takes a walk over some cells from a vertex nearby, microseconds, however many there
/// are; the first question also prepares for all.
Length length_of_questions(const Cells& cells, std::uint64_t count) {
  if (!cells.is_prepared()) return length_of(cells.points().view(), cells.triangulation().size());
  return count <= 100 ? Length::brief : count <= 100'000 ? Length::moderate : Length::long_;
}

/// Calls ask(query, view, options) under run().
template <class Ask>
void ask_all(const Cells& cells, const PointView& view, const Settings* settings, Ask&& ask) {
  require_same_dimension(cells, view);
  run(settings, length_of_questions(cells, view.count),
      [&](const Options& options) { ask(cells.query(options), view, options); });
}

/// Throws unless there is a cell, or -1, for each of `count` points.
void check_cells(const Cells& cells, Array<std::int32_t> found, std::size_t count) {
  const auto all = static_cast<std::int64_t>(cells.triangulation().size());
  if (!found.is_list() || found.size() != count) throw nb::value_error("a cell for each point");
  for (std::size_t i = 0; i < count; ++i)
    if (found.data()[i] < -1 || found.data()[i] >= all)
      throw cullhull::Error(cullhull::ErrorCode::invalid_argument,
                            "there is no cell " + std::to_string(found.data()[i]));
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
  check_cells(cells, found, count);
  Output<double> out(count * corners);
  ask_all(cells, points.view(), settings,
          [&](const TriangulationQuery& query, const PointView& view, const Options& options) {
    query.barycentric(view, reinterpret_cast<const std::uint32_t*>(found.data()), out.data(),
                      options);
  });
  return std::move(out).to_array();
}

/// One after another, the sums of the values (`components` a vertex) at the corners of the points'
/// cells, weighted by barycentric coordinates; NaN without a cell.
Array<double> linear(const Cells& cells, nb::handle array, Array<std::int32_t> found,
                     Array<double> values, std::uint32_t components, const Settings* settings) {
  const Points points(array);
  const cullhull::Triangulation& t = cells.triangulation();
  const std::size_t count = points.view().count, corners = t.corners(), width = components;
  check_cells(cells, found, count);
  if (!values.is_list() || values.size() != t.point_count * width)
    throw nb::value_error("a value for each point");
  Output<double> out(count * width);
  ask_all(cells, points.view(), settings,
          [&](const TriangulationQuery& query, const PointView& view, const Options& options) {
    std::vector<double> shares(count * corners);
    query.barycentric(view, reinterpret_cast<const std::uint32_t*>(found.data()), shares.data(),
                      options);
    for (std::size_t i = 0; i < count; ++i) {
      double* const row = out.data() + i * width;
      const bool inside = found.data()[i] >= 0;
      std::fill_n(row, width, inside ? 0 : std::numeric_limits<double>::quiet_NaN());
      if (!inside) continue;
      const auto vertices = t.cell(static_cast<std::size_t>(found.data()[i]));
      for (std::size_t j = 0; j < corners; ++j) {
        const double share = shares[i * corners + j];
        const double* const value = values.data() + vertices[j] * width;
        for (std::size_t c = 0; c < width; ++c) row[c] += share * value[c];
      }
    }
  });
  return std::move(out).to_array();
}

}  // namespace

void bind_cells_query(nb::class_<Cells>& c) {
  c.def("find", find, nb::arg("points"), nb::arg("settings").none())
      .def("nearest", nearest, nb::arg("points"), nb::arg("settings").none())
      .def("barycentric", barycentric, nb::arg("points"), nb::arg("cells"),
           nb::arg("settings").none())
      .def("linear", linear, nb::arg("points"), nb::arg("cells"), nb::arg("values"),
           nb::arg("components"), nb::arg("settings").none());
}

}  // namespace binding
