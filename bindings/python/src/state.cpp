// Hulls, batches and triangulations as plain values and arrays, and back: for pickle and what is
// based on it.
#include <nanobind/nanobind.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/unique_ptr.h>

#include <algorithm>
#include <memory>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "arrays.hpp"
#include "batch.hpp"
#include "cullhull/error.hpp"
#include "solid.hpp"
#include "statistics.hpp"
#include "triangulation.hpp"

namespace binding {

using cullhull::EvenArray;
using cullhull::Hull;
using cullhull::HullBatch;
using cullhull::ScalarType;
using cullhull::Triangulation;

namespace {

using State = nb::typed<nb::dict, nb::str, nb::any>;

constexpr int state_version = 1;

[[noreturn]] void refuse(const char* what) {
  throw cullhull::Error(cullhull::ErrorCode::invalid_argument,
                        std::string("this is not the pickled state of such a result: ") + what);
}
void require(bool holds, const char* what) {
  if (!holds) refuse(what);
}

/// A view of `list`, whose memory `owner` keeps; (count, step) where the items are not stored.
template <class List>
nb::object saved(const List& list, nb::handle owner) {
  return list_in(list, owner);
}
template <class T>
nb::object saved(const EvenArray<T>& list, nb::handle owner) {
  if (list.step() != nullptr) return nb::make_tuple(list.size(), *list.step());
  return list_of(shown_data(list), list.size(), owner);
}

nb::object item(const State& state, const char* name) {
  require(state.contains(name), name);
  return state[name];
}
template <class T>
T value(const State& state, const char* name) {
  try {
    return nb::cast<T>(item(state, name));
  } catch (const nb::cast_error&) {
    refuse(name);
  }
}

/// Fills a vector of any allocator.
template <class List>
void load(const State& state, const char* name, List& list) {
  using T = typename List::value_type;
  auto array = value<Array<shown_t<T>>>(state, name);
  require(array.is_list(), name);
  const T* const data = reinterpret_cast<const T*>(array.data());
  list.assign(data, data + array.size());
}
template <class T>
void load(const State& state, const char* name, cullhull::SharedArray<T>& list) {
  load(state, name, list.edit());
}
template <class T>
void load(const State& state, const char* name, EvenArray<T>& list) {
  const nb::object stored = item(state, name);
  if (!nb::isinstance<nb::tuple>(stored)) {
    load(state, name, list.edit());
    return;
  }
  std::size_t count = 0;
  T step = 0;
  const nb::tuple even = nb::borrow<nb::tuple>(stored);
  require(even.size() == 2 && nb::try_cast(even[0], count) && nb::try_cast(even[1], step), name);
  list = EvenArray<T>::of_step(count, step);
}

/// Runs the caller's signal handlers once in 16,384 steps of a loop, so that Ctrl-C ends it.
class SignalSteps {
 public:
  void next() {
    if (++steps_ % (1U << 14) == 0 && PyErr_CheckSignals() != 0) throw nb::python_error();
  }

 private:
  std::uint32_t steps_ = 0;
};

/// Whether all items of a list are as `holds` says.
template <class List, class Holds>
bool all_hold(const List& list, const Holds& holds) {
  SignalSteps steps;
  return std::all_of(list.begin(), list.end(), [&](auto v) {
    steps.next();
    return holds(v);
  });
}

/// Offsets ascend from 0 to the number of items.
template <class Offsets>
void check_offsets(const Offsets& offsets, std::size_t items, const char* name) {
  require(offsets.size() > 0 && offsets[0] == 0 && offsets[offsets.size() - 1] == items, name);
  SignalSteps steps;
  for (std::size_t i = 1; i < offsets.size(); ++i) {
    steps.next();
    require(offsets[i - 1] <= offsets[i], name);
  }
}
template <class ListsOf>
void check_offsets(const ListsOf& lists, const char* name) {
  check_offsets(lists.offsets, lists.items.size(), name);
}
template <class List>
void check_below(const List& list, std::uint64_t bound, const char* name) {
  require(all_hold(list, [bound](auto v) { return v < bound; }), name);
}

ScalarType scalar_named(const std::string& name) {
  for (const auto& [type, number] : scalar_types)
    if (name == cullhull::scalar_name(type)) return type;
  refuse("scalar");
}

/// The value up to `last` whose name is `text`; the first one for a text that is none's.
template <class Enum>
bool load_member(nb::handle text, Enum& member, Enum last, const char* (*name)(Enum) noexcept) {
  std::string word;
  if (!nb::try_cast(text, word)) return false;
  member = Enum{};
  for (int i = 0; i <= static_cast<int>(last); ++i)
    if (word == name(static_cast<Enum>(i))) member = static_cast<Enum>(i);
  return true;
}
bool load_member(nb::handle text, cullhull::UsedFilter& member) {
  return load_member(text, member, cullhull::UsedFilter::stream, cullhull::filter_name);
}
bool load_member(nb::handle text, cullhull::Backend& member) {
  return load_member(text, member, cullhull::Backend::cuda, cullhull::backend_name);
}
template <class T>
bool load_member(nb::handle value, T& member) {
  return nb::try_cast(value, member);
}

/// The members one after another, an array's items too.
template <class Statistics>
nb::tuple saved_statistics(const Statistics& statistics) {
  nb::list all;
  each_statistic(statistics, [&](const char*, const auto& member) {
    if constexpr (std::is_array_v<std::remove_reference_t<decltype(member)>>)
      for (const auto& item : member) all.append(item);
    else
      all.append(plain(member));
  });
  return nb::tuple(all);
}
template <class Statistics>
void load_statistics(const State& state, Statistics& statistics) {
  const auto all = value<nb::tuple>(state, "statistics");
  std::size_t at = 0;
  const auto next = [&](auto& member) {
    require(at < all.size() && load_member(all[at], member), "statistics");
    ++at;
  };
  each_statistic(statistics, [&](const char*, auto& member) {
    if constexpr (std::is_array_v<std::remove_reference_t<decltype(member)>>)
      for (auto& item : member) next(item);
    else
      next(member);
  });
  require(at == all.size(), "statistics");
}

void check_version(const State& state) {
  const int version = value<int>(state, "version");
  if (version != state_version)
    throw cullhull::Error(cullhull::ErrorCode::invalid_argument,
                          "a result pickled by another version of cullhull (state " +
                              std::to_string(version) + ", this one reads " +
                              std::to_string(state_version) + ")");
}

// The members that both have: `each(name, member)`.

template <class H, class Each>
void each_member(H& h, Each&& each) {
  each("facet_offsets", h.facets.offsets);
  each("facet_neighbour_offsets", h.facet_neighbours.offsets);
  each("facet_neighbours", h.facet_neighbours.items);
  each("facet_planes", h.facet_planes);
}
template <class Each>
void each_list(Hull& h, Each&& each) {
  each_member(h, each);
  each("vertices", h.vertices);
  each("simplices", h.simplices);
  each("simplex_neighbours", h.simplex_neighbours);
  each("simplex_facets", h.simplex_facets);
  each("centroid", h.centroid);
}
template <class Each>
void each_list(HullBatch& b, Each&& each) {
  each_member(b, each);
  each("facet_vertices", b.facets.items);
  each("point_counts", b.point_counts);
  each("affine_dimensions", b.affine_dimensions);
  each("volumes", b.volumes);
  each("areas", b.areas);
  each("centroids", b.centroids);
  each("vertex_offsets", b.vertices.offsets);
  each("vertices", b.vertices.items);
  each("facet_starts", b.facet_starts);
  each("simplex_offsets", b.simplices.offsets);
  each("simplices", b.simplices.items);
  each("simplex_neighbour_offsets", b.simplex_neighbours.offsets);
  each("simplex_neighbours", b.simplex_neighbours.items);
  each("simplex_facet_offsets", b.simplex_facets.offsets);
  each("simplex_facets", b.simplex_facets.items);
}

template <class Each>
void each_list(Triangulation& t, Each&& each) {
  each("axes", t.axes);
  each("cells", t.cells);
  each("neighbours", t.neighbours);
  each("cell_groups", t.cell_groups);
  each("hull_facets", t.hull_facets);
  each("hull_cells", t.hull_cells);
  each("hidden", t.hidden);
}

template <class H>
State saved_lists(const H& h, nb::handle owner) {
  State state;
  state["version"] = state_version;
  state["dimension"] = h.dimension;
  state["scalar"] = cullhull::scalar_name(h.scalar);
  each_list(const_cast<H&>(h), [&](const char* name, const auto& list) {  // reads only
    state[name] = saved(list, owner);
  });
  return state;
}
template <class H>
void load_lists(const State& state, H& h) {
  check_version(state);
  h.dimension = value<std::uint32_t>(state, "dimension");
  h.scalar = scalar_named(value<std::string>(state, "scalar"));
  require(h.dimension > 0 || h.facet_planes.empty(), "dimension");
  each_list(h, [&](const char* name, auto& list) { load(state, name, list); });
}

State state_of_solid(SolidHandle self) {
  const Hull& h = hull_in(self);
  State state = saved_lists(h, self);
  state["point_count"] = h.point_count;
  state["affine_dimension"] = h.affine_dimension;
  state["volume"] = h.volume;
  state["area"] = h.area;
  // Usually the facets are the simplices, and share one list.
  state["facet_vertices"] =
      h.facets.items.shares(h.simplices) ? nb::none() : saved(h.facets.items, self);
  state["vertex_rows"] = saved(nb::inst_ptr<Solid>(self)->vertex_rows(), self);
  state["statistics"] = saved_statistics(h.statistics);
  return state;
}

/// Checks every index that a query would use: a wrong one must not lead out of an array.
void check(const Hull& h, const std::vector<double>& vertex_rows) {
  const std::size_t d = h.dimension, k = simplex_width(h), facets = h.facet_count();
  require(d > 0 && h.affine_dimension >= -1 && h.affine_dimension <= static_cast<int>(d),
          "affine_dimension");
  require(vertex_rows.size() == h.vertices.size() * d, "vertex_rows");
  require(h.centroid.size() == (h.affine_dimension < 0 ? 0 : d), "centroid");
  require(h.facet_planes.size() == facets * (d + 1), "facet_planes");
  require(h.facet_neighbours.size() == facets, "facet_neighbours");
  require(h.simplices.size() == h.simplex_count() * k, "simplices");
  require(h.simplex_neighbours.size() == h.simplices.size(), "simplex_neighbours");
  check_offsets(h.facets, "facet_offsets");
  check_offsets(h.facet_neighbours, "facet_neighbour_offsets");
  check_below(h.vertices, h.point_count, "vertices");
  check_below(h.facet_neighbours.items, facets, "facet_neighbours");
  check_below(h.simplex_neighbours, h.simplex_count(), "simplex_neighbours");
  check_below(h.simplex_facets, facets, "simplex_facets");
  std::vector<std::uint64_t> ids = h.vertices;
  SignalSteps steps;
  std::sort(ids.begin(), ids.end(), [&](std::uint64_t a, std::uint64_t b) {
    steps.next();
    return a < b;
  });
  require(std::adjacent_find(ids.begin(), ids.end()) == ids.end(), "vertices");
  const auto is_vertex = [&](std::uint64_t id) {
    return std::binary_search(ids.begin(), ids.end(), id);
  };
  require(all_hold(h.simplices, is_vertex), "simplices");
  require(all_hold(h.facets.items, is_vertex), "facet_vertices");
}

std::unique_ptr<Solid> solid_of_state(const State& state) {
  Hull h;
  load_lists(state, h);
  h.point_count = value<std::uint64_t>(state, "point_count");
  h.affine_dimension = value<int>(state, "affine_dimension");
  h.volume = value<double>(state, "volume");
  h.area = value<double>(state, "area");
  if (item(state, "facet_vertices").is_none())
    h.facets.items = h.simplices;
  else
    load(state, "facet_vertices", h.facets.items);
  load_statistics(state, h.statistics);
  std::vector<double> vertex_rows;
  load(state, "vertex_rows", vertex_rows);
  check(h, vertex_rows);
  return std::make_unique<Solid>(std::move(h), std::move(vertex_rows));
}

State state_of_batch(nb::handle_t<Batch> self) {
  const Batch& batch = *nb::inst_ptr<Batch>(self);
  State state = saved_lists(batch.hulls, self);
  state["vertex_rows"] = saved(batch.vertex_rows, self);
  return state;
}

/// Checks the lists of all sets; those of a single set are checked when it is requested
/// (Batch::at).
void check(const Batch& batch) {
  const HullBatch& b = batch.hulls;
  const std::size_t sets = b.size(), facets = b.facets.size();
  require(b.dimension > 0 || sets == 0, "dimension");
  require(b.affine_dimensions.size() == sets && b.volumes.size() == sets &&
              b.areas.size() == sets && b.centroids.size() == sets * b.dimension,
          "affine_dimensions");
  require(b.vertices.size() == sets && b.simplices.size() == sets &&
              b.simplex_neighbours.size() == sets && b.simplex_facets.size() == sets &&
              b.facet_starts.size() == sets + 1 && b.facet_neighbours.size() == facets,
          "vertices");
  require(b.facet_planes.size() == facets * (b.dimension + std::size_t{1}), "facet_planes");
  require(batch.vertex_rows.size() == b.vertices.items.size() * b.dimension, "vertex_rows");
  check_offsets(b.facet_starts, facets, "facet_starts");
  check_offsets(b.facets, "facet_offsets");
  check_offsets(b.facet_neighbours, "facet_neighbour_offsets");
  check_offsets(b.vertices, "vertex_offsets");
  check_offsets(b.simplices, "simplex_offsets");
  check_offsets(b.simplex_neighbours, "simplex_neighbour_offsets");
  check_offsets(b.simplex_facets, "simplex_facet_offsets");
  for (std::size_t i = 0; i < sets; ++i) {
    const std::unique_ptr<Solid> solid = batch.at(i);
    check(solid->hull(), solid->vertex_rows());
  }
}

std::unique_ptr<Batch> batch_of_state(const State& state) {
  auto batch = std::make_unique<Batch>();
  load_lists(state, batch->hulls);
  load(state, "vertex_rows", batch->vertex_rows);
  check(*batch);
  return batch;
}

State state_of_cells(CellsHandle self) {
  const Cells& cells = cells_in(self);
  const Triangulation& t = cells.triangulation();
  State state;
  state["version"] = state_version;
  state["points"] = cells.points_array();
  state["weights"] = cells.weights_array();
  state["affine_dimension"] = t.affine_dimension;
  state["furthest_site"] = t.furthest_site;
  each_list(const_cast<Triangulation&>(t), [&](const char* name, const auto& list) {  // reads only
    state[name] = saved(list, self);
  });
  std::vector<std::uint32_t> pairs;
  for (const cullhull::DuplicatePoint& p : t.duplicates) {
    pairs.push_back(p.id);
    pairs.push_back(p.representative);
  }
  state["duplicates"] = kept(pairs);
  state["statistics"] = saved_statistics(t.statistics);
  return state;
}

/// Whether the cells that a neighbour reference joins share a facet and refer to each other; and
/// whether the hull's facets are those without a neighbour. Other links would lead a walk around in
/// a loop.
void check_links(const Triangulation& t) {
  const unsigned corners = t.corners();
  std::size_t open = 0;
  SignalSteps steps;
  for (std::uint32_t c = 0; c < t.size(); ++c) {
    steps.next();
    const auto own = t.cell(c), across = t.neighbours_of(c);
    for (unsigned i = 1; i < corners; ++i)
      require(std::find(own.begin(), own.begin() + i, own[i]) == own.begin() + i, "cells");
    for (unsigned j = 0; j < corners; ++j) {
      const std::uint32_t o = across[j];
      if (o == cullhull::no_index) {
        ++open;
        continue;
      }
      const auto other = t.cell(o), back = t.neighbours_of(o);
      require(o != c && std::count(back.begin(), back.end(), c) == 1, "neighbours");
      const auto apex =
          static_cast<std::size_t>(std::find(back.begin(), back.end(), c) - back.begin());
      for (unsigned i = 0; i < corners; ++i) {
        const auto at =
            static_cast<std::size_t>(std::find(other.begin(), other.end(), own[i]) - other.begin());
        require(i == j ? at == corners : at < corners && at != apex, "neighbours");
      }
    }
  }
  if (corners < 2) return;
  require(t.hull_cells.size() == open, "hull_facets");
  for (std::size_t f = 0; f < t.hull_cells.size(); ++f) {
    steps.next();
    const auto facet = t.hull_facet(f);
    const auto cell = t.cell(t.hull_cells[f]), across = t.neighbours_of(t.hull_cells[f]);
    unsigned outside = 0;
    for (unsigned i = 0; i < corners; ++i)
      if (std::find(facet.begin(), facet.end(), cell[i]) == facet.end()) {
        ++outside;
        require(across[i] == cullhull::no_index, "hull_facets");
      }
    require(outside == 1, "hull_facets");
  }
}

/// Whatever a walk would go by: a wrong number must not lead out of an array.
void check(const Triangulation& t) {
  const std::size_t corners = t.corners(), cells = t.size(), facets = t.hull_cells.size();
  require(t.dimension > 0 && t.affine_dimension >= -1 &&
              t.affine_dimension <= static_cast<int>(t.dimension),
          "affine_dimension");
  require(t.axes.size() + (t.affine_dimension < 0 ? 0 : 1) == corners, "axes");
  require(t.cells.size() == cells * corners && t.neighbours.size() == t.cells.size(), "cells");
  require(t.cell_groups.empty() || t.cell_groups.size() == cells, "cell_groups");
  require(t.hull_facets.size() == facets * (corners == 0 ? 0 : corners - 1), "hull_facets");
  require(t.point_count < cullhull::no_index && cells < cullhull::no_index, "points");
  check_below(t.axes, t.dimension, "axes");
  check_below(t.cells, t.point_count, "cells");
  require(
      all_hold(t.neighbours, [&](std::uint32_t n) { return n < cells || n == cullhull::no_index; }),
      "neighbours");
  check_below(t.cell_groups, cells, "cell_groups");
  check_below(t.hull_facets, t.point_count, "hull_facets");
  check_below(t.hull_cells, cells, "hull_cells");
  check_below(t.hidden, t.point_count, "hidden");
  for (const cullhull::DuplicatePoint& p : t.duplicates)
    require(p.id < t.point_count && p.representative < t.point_count, "duplicates");
  check_links(t);
}

std::unique_ptr<Cells> cells_of_state(const State& state) {
  check_version(state);
  Triangulation t;
  nb::object array = item(state, "points"), weights = item(state, "weights");
  const cullhull::PointView view = Points(array).view();
  t.dimension = view.dimension;
  t.point_count = view.count;
  t.scalar = view.scalar;
  t.affine_dimension = value<int>(state, "affine_dimension");
  t.furthest_site = value<bool>(state, "furthest_site");
  require(weights.is_none() || weights_of(weights).size() == t.point_count, "weights");
  each_list(t, [&](const char* name, auto& list) { load(state, name, list); });
  std::vector<std::uint32_t> pairs;
  load(state, "duplicates", pairs);
  require(pairs.size() % 2 == 0, "duplicates");
  for (std::size_t i = 0; i < pairs.size(); i += 2)
    t.duplicates.push_back({pairs[i], pairs[i + 1]});
  load_statistics(state, t.statistics);
  check(t);
  return std::make_unique<Cells>(std::move(t), std::move(array), std::move(weights));
}

}  // namespace

void bind_state(nb::module_& m) {
  m.def("state_of_cells", state_of_cells, nb::arg("cells"));
  m.def("cells_of_state", cells_of_state, nb::arg("state"));
  m.def("state_of_solid", state_of_solid, nb::arg("solid"));
  m.def("solid_of_state", solid_of_state, nb::arg("state"));
  m.def("state_of_batch", state_of_batch, nb::arg("batch"));
  m.def("batch_of_state", batch_of_state, nb::arg("state"));
}

}  // namespace binding
