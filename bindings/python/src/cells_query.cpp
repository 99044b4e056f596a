// Questions to a triangulation, one array of them at a time.
#include <nanobind/stl/pair.h>
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
  std::call_once(prepared_, [&] {
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
  std::call_once(planted_, [&] {
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

/// The same, and whether any point is in no cell.
std::pair<Array<std::int32_t>, bool> find_some(const Cells& cells, nb::handle array,
                                               const Settings* settings) {
  Array<std::int32_t> found = find(cells, array, settings);
  const bool outside = std::any_of(found.data(), found.data() + found.size(),
                                   [](std::int32_t cell) { return cell < 0; });
  return {std::move(found), outside};
}

/// Some points of a view, as rows.
class Chosen {
 public:
  Chosen(const PointView& from, const std::vector<double>& all, std::vector<std::size_t> numbers)
      : numbers_(std::move(numbers)), rows_(numbers_.size() * from.dimension) {
    const std::size_t d = from.dimension;
    for (std::size_t i = 0; i < numbers_.size(); ++i)
      std::copy_n(all.data() + numbers_[i] * d, d, rows_.data() + i * d);
    view_ = PointView::row_major(rows_.data(), numbers_.size(), from.dimension);
  }
  Chosen(const Chosen&) = delete;
  Chosen& operator=(const Chosen&) = delete;

  const PointView& view() const { return view_; }
  std::size_t size() const { return numbers_.size(); }
  /// The number in the view of the i-th.
  std::size_t operator[](std::size_t i) const { return numbers_[i]; }

 private:
  std::vector<std::size_t> numbers_;
  std::vector<double> rows_;
  PointView view_;
};

/// For points outside, `found` being -1: sets the cell that a tolerance puts them into. The cell
/// from which a point sticks out is met on the way to the middle of all: one looks a share of that
/// way, then a quarter of it, and takes a cell if no barycentric coordinate of the point is below
/// -tolerance. `frame`: the least coordinates of the triangulated points, the largest ones, their
/// means.
void find_near(const Cells& cells, nb::handle array, Array<std::int32_t> found, Array<double> frame,
               double tolerance, double share, const Settings* settings) {
  const Points points(array);
  const PointView& view = points.view();
  require_same_dimension(cells, view);
  const std::size_t d = view.dimension, corners = cells.triangulation().corners();
  if (!found.is_list() || found.size() != view.count || !frame.is_list() || frame.size() != 3 * d)
    throw nb::value_error("a cell for each point, and a frame");
  const double *const low = frame.data(), *const high = low + d, *const middle = high + d;
  const std::vector<double> all = rows_of_view(view);
  std::vector<std::size_t> open;
  for (std::size_t i = 0; i < view.count; ++i) {
    bool near = found.data()[i] < 0;
    for (std::size_t j = 0; j < d && near; ++j) {
      const double x = all[i * d + j];
      const double margin = static_cast<double>(d + 1) * tolerance * (high[j] - low[j]);
      near = x >= low[j] - margin && x <= high[j] + margin;
    }
    if (near) open.push_back(i);
  }
  for (const double pull : {share, 0.25 * share}) {
    if (open.empty()) return;
    const Chosen at(view, all, std::move(open));
    std::vector<double> pulled(at.size() * d);
    for (std::size_t i = 0; i < at.size(); ++i)
      for (std::size_t j = 0; j < d; ++j) {
        const double x = all[at[i] * d + j];
        pulled[i * d + j] = x + pull * (middle[j] - x);
      }
    PointView there = at.view();
    there.data = reinterpret_cast<const std::byte*>(pulled.data());
    std::vector<std::uint32_t> there_cells(at.size());
    std::vector<double> shares(at.size() * corners);
    ask_all(cells, there, settings,
            [&](const TriangulationQuery& query, const PointView& asked, const Options& options) {
      query.find(asked, there_cells.data(), options);
      const bool any = std::any_of(there_cells.begin(), there_cells.end(),
                                   [](std::uint32_t cell) { return cell != cullhull::no_index; });
      if (any) query.barycentric(at.view(), there_cells.data(), shares.data(), options);
    });
    open.clear();
    for (std::size_t i = 0; i < at.size(); ++i) {
      const double* const own = shares.data() + i * corners;
      if (there_cells[i] != cullhull::no_index &&
          std::all_of(own, own + corners, [&](double x) { return x >= -tolerance; }))
        found.data()[at[i]] = static_cast<std::int32_t>(there_cells[i]);
      else
        open.push_back(at[i]);
    }
  }
}

Array<std::int32_t> nearest(const Cells& cells, nb::handle array, const Settings* settings) {
  const Points points(array);
  check_numbers(cells.triangulation().point_count);
  const PointView& view = points.view();
  require_same_dimension(cells, view);
  Output<std::uint32_t> out(view.count);
  bool answered = false;
  run(settings,
      cells.has_tree() ? length_of_questions(view.count) : length_of(cells.points().view()),
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
Array<double> linear(const Cells& cells, nb::handle array, Array<std::int32_t> found,
                     Array<double> values, std::uint32_t components,
                     const std::vector<double>& outside, const Settings* settings) {
  const Points points(array);
  const PointView& view = points.view();
  const cullhull::Triangulation& t = cells.triangulation();
  const std::size_t count = view.count, corners = t.corners(), width = components;
  check_cells(cells, found, count);
  if (!values.is_contiguous() || values.size() != t.point_count * width || outside.empty())
    throw nb::value_error("a value for each point");
  const std::int32_t* const own = found.data();
  const auto missing = static_cast<std::size_t>(
      std::count_if(own, own + count, [](std::int32_t cell) { return cell < 0; }));
  Output<double> out(count * width);
  if (missing > 0)
    for (std::size_t i = 0; i < count; ++i)
      for (std::size_t c = 0; c < width && own[i] < 0; ++c)
        out.data()[i * width + c] = outside[c % outside.size()];
  if (missing == count) return std::move(out).to_array();
  /// `number(i)`: of the i-th of `asked` its place among all.
  const auto interpolate =
      [&](const PointView& asked, const std::uint32_t* in, const auto& number) {
    ask_all(cells, asked, settings,
            [&](const TriangulationQuery& query, const PointView&, const Options& options) {
      std::vector<double> shares(asked.count * corners);
      query.barycentric(asked, in, shares.data(), options);
      for (std::size_t i = 0; i < asked.count; ++i) {
        double* const row = out.data() + number(i) * width;
        std::fill_n(row, width, 0.0);
        const auto vertices = t.cell(in[i]);
        for (std::size_t j = 0; j < corners; ++j) {
          const double share = shares[i * corners + j];
          const double* const value = values.data() + vertices[j] * width;
          for (std::size_t c = 0; c < width; ++c) row[c] += share * value[c];
        }
      }
    });
  };
  if (missing == 0) {
    interpolate(view, reinterpret_cast<const std::uint32_t*>(own), [](std::size_t i) { return i; });
  } else {
    std::vector<std::size_t> inside;
    std::vector<std::uint32_t> in;
    for (std::size_t i = 0; i < count; ++i) {
      if (own[i] < 0) continue;
      inside.push_back(i);
      in.push_back(static_cast<std::uint32_t>(own[i]));
    }
    const Chosen chosen(view, rows_of_view(view), std::move(inside));
    interpolate(chosen.view(), in.data(), [&](std::size_t i) { return chosen[i]; });
  }
  return std::move(out).to_array();
}

}  // namespace

void bind_cells_query(nb::module_& m, nb::class_<Cells>& c) {
  c.def("find", find, nb::arg("points"), nb::arg("settings").none())
      .def("find_some", find_some, nb::arg("points"), nb::arg("settings").none())
      .def("find_near", find_near, nb::arg("points"), nb::arg("cells"), nb::arg("frame"),
           nb::arg("tolerance"), nb::arg("share"), nb::arg("settings").none())
      .def("nearest", nearest, nb::arg("points"), nb::arg("settings").none())
      .def("barycentric", barycentric, nb::arg("points"), nb::arg("cells"),
           nb::arg("settings").none())
      .def("linear", linear, nb::arg("points"), nb::arg("cells"), nb::arg("values"),
           nb::arg("components"), nb::arg("outside"), nb::arg("settings").none());
  nb::class_<NearestPoint>(m, "NearestTree", "Points, to be asked for the nearest one.")
      .def("nearest", ask_for_nearest, nb::arg("points"), nb::arg("settings").none());
  m.def("nearest_tree", nearest_tree, nb::arg("points"), nb::arg("settings").none());
}

}  // namespace binding
