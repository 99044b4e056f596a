// Questions to a triangulation, one array of them at a time.
#include <nanobind/stl/string.h>
#include <nanobind/stl/unique_ptr.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "arrays.hpp"
#include "cullhull/error.hpp"
#include "triangulation.hpp"

namespace binding {

using cullhull::NearestPoint;
using cullhull::Options;
using cullhull::PointView;
using cullhull::TriangulationQuery;

const TriangulationQuery& Cells::query(const Options& options) const {
  prepared_.call([&] {
    query_ =
        std::make_unique<TriangulationQuery>(points_.view(), triangulation_, weights_, options);
    is_prepared_ = true;
  });
  return *query_;
}

const NearestPoint* Cells::tree(const Options& options) const {
  const PointView& view = points_.view();
  if (!weights_array_.is_none() || triangulation_.furthest_site || view.count == 0 ||
      view.dimension > NearestPoint::most_dimensions)
    return nullptr;
  planted_.call([&] {
    tree_ = std::make_unique<const NearestPoint>(view, options);
    has_tree_ = true;
  });
  return tree_.get();
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
Length length_of_questions(std::uint64_t count) {
  return count <= 100 ? Length::brief : count <= 100'000 ? Length::moderate : Length::long_;
}
Length length_of_questions(const Cells& cells, std::uint64_t count) {
  if (!cells.is_prepared()) return length_of(cells.points().view(), cells.triangulation().size());
  return length_of_questions(count);
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

/// With a tolerance also the cells of points that are outside by rounding alone.
Array<std::int32_t> find(const Cells& cells, nb::handle array, double tolerance,
                         const Settings* settings) {
  const Points points(array);
  check_numbers(cells.triangulation().size());
  Output<std::uint32_t> out(points.view().count);
  ask_all(cells, points.view(), settings,
          [&](const TriangulationQuery& query, const PointView& view, const Options& options) {
    query.find(view, out.data(), options, tolerance);
  });
  return std::move(out).to_array<std::int32_t>();
}

Array<std::int32_t> nearest(const Cells& cells, nb::handle array, const Settings* settings) {
  const Points points(array);
  check_numbers(cells.triangulation().point_count);
  const PointView& view = points.view();
  require_same_dimension(cells, view);
  Output<std::uint32_t> out(view.count);
  bool answered = false;
  const Length asking = length_of_questions(view.count);
  run(settings, cells.has_tree() ? asking : std::max(asking, length_of(cells.points().view())),
      [&](const Options& options) {
    const NearestPoint* const tree = cells.tree(options);
    if (tree != nullptr) tree->nearest(view, out.data(), options);
    answered = tree != nullptr;
  });
  if (!answered)
    ask_all(cells, view, settings,
            [&](const TriangulationQuery& query, const PointView&, const Options& options) {
      query.nearest(view, out.data(), options);
    });
  return std::move(out).to_array<std::int32_t>();
}

/// Points alone, to be asked for the nearest of them. None in more dimensions than a tree takes.
std::unique_ptr<NearestPoint> nearest_tree(nb::handle array, const Settings* settings) {
  const Points points(array);
  const PointView& view = points.view();
  check_numbers(view.count);
  if (view.dimension > NearestPoint::most_dimensions) return nullptr;
  return computed(settings, length_of(view), [&](const Options& options) {
    return std::make_unique<NearestPoint>(view, options);
  });
}

Array<std::int32_t> ask_for_nearest(const NearestPoint& tree, nb::handle array,
                                    const Settings* settings) {
  const Points points(array);
  const PointView& view = points.view();
  Output<std::uint32_t> out(view.count);
  run(settings, length_of_questions(view.count),
      [&](const Options& options) { tree.nearest(view, out.data(), options); });
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
/// cells, weighted by barycentric coordinates; without a cell `outside`, again and again.
Array<double> linear(const Cells& cells, nb::handle array, Array<double> values,
                     std::uint32_t components, const std::vector<double>& outside, double tolerance,
                     const Settings* settings) {
  const Points points(array);
  const std::size_t width = components;
  if (!values.is_contiguous() || values.size() != cells.triangulation().point_count * width)
    throw nb::value_error("a value for each point");
  Output<double> out(points.view().count * width);
  if (width == 0) return std::move(out).to_array();
  const double* const from = values.data();
  ask_all(cells, points.view(), settings,
          [&](const TriangulationQuery& query, const PointView& view, const Options& options) {
    query.interpolate(view, from, components, outside, out.data(), options, tolerance);
  });
  return std::move(out).to_array();
}

}  // namespace

void bind_cells_query(nb::module_& m, nb::class_<Cells>& c) {
  c.def("find", find, nb::arg("points"), nb::arg("tolerance"), nb::arg("settings").none())
      .def("nearest", nearest, nb::arg("points"), nb::arg("settings").none())
      .def("barycentric", barycentric, nb::arg("points"), nb::arg("cells"),
           nb::arg("settings").none())
      .def("linear", linear, nb::arg("points"), nb::arg("values"), nb::arg("components"),
           nb::arg("outside"), nb::arg("tolerance"), nb::arg("settings").none());
  nb::class_<NearestPoint>(m, "NearestTree", "Points, to be asked for the nearest one.")
      .def("nearest", ask_for_nearest, nb::arg("points"), nb::arg("settings").none());
  m.def("nearest_tree", nearest_tree, nb::arg("points"), nb::arg("settings").none());
}

}  // namespace binding
