// Voronoi and power diagrams, whole and within a region.
#include "cullhull/voronoi.hpp"

#include <nanobind/stl/string.h>
#include <nanobind/stl/unique_ptr.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <limits>
#include <memory>
#include <span>
#include <vector>

#include "arrays.hpp"
#include "solid.hpp"
#include "triangulation.hpp"

namespace binding {

using cullhull::ClippedCells;
using cullhull::Options;
using cullhull::Voronoi;

namespace {

// Arrays of the results, as views of memory that `self` keeps.

template <class List>
Array<std::int64_t> offsets_in(const List& list, nb::handle self) {
  return list_of(reinterpret_cast<const std::int64_t*>(list.data()), list.size(), self);
}
Array<std::int64_t> offsets_in(const cullhull::EvenArray<std::uint64_t>& list, nb::handle self) {
  return signed_list(list, self);
}
/// int32, with -1 for at_infinity and no_index.
template <class List>
Array<std::int32_t> numbers_in(const List& list, nb::handle self) {
  return list_of(reinterpret_cast<const std::int32_t*>(list.data()), list.size(), self);
}
template <class List>
Array<double> rows_in(const List& list, std::size_t width, nb::handle self) {
  return rows_of(list.data(), width == 0 ? 0 : list.size() / width, width, self);
}

using Self = nb::handle_t<Voronoi>;
const Voronoi& shown(Self self) { return *nb::inst_ptr<Voronoi>(self); }
using ClippedSelf = nb::handle_t<ClippedCells>;
const ClippedCells& shown_cells(ClippedSelf self) { return *nb::inst_ptr<ClippedCells>(self); }

/// Some microseconds a cell.
Length length_of_diagram(const Cells& cells) noexcept {
  const std::uint64_t n = cells.triangulation().size();
  return n <= 200 ? Length::brief : n <= 20'000 ? Length::moderate : Length::long_;
}

std::unique_ptr<Voronoi> voronoi(const Cells& cells, const Settings* settings) {
  auto result = computed(settings, length_of_diagram(cells), [&](const Options& options) {
    return std::make_unique<Voronoi>(
        cullhull::voronoi(cells.points().view(), cells.triangulation(), cells.weights(), options));
  });
  check_numbers(result->vertex_count());
  check_numbers(result->point_count);
  return result;
}

cullhull::ClipOptions clipping(const Options& options, bool shapes, const Voronoi& diagram) {
  auto o = cullhull::options_as<cullhull::ClipOptions>(options);
  o.shapes = shapes;
  o.diagram = &diagram;
  return o;
}

/// `region`: what clip_voronoi() takes behind the triangulation.
template <class... Region>
std::unique_ptr<ClippedCells> clip(const Cells& cells, const Voronoi& diagram, bool shapes,
                                   const Settings* settings, const Region&... region) {
  return computed(settings, length_of_diagram(cells), [&](const Options& options) {
    return std::make_unique<ClippedCells>(
        cullhull::clip_voronoi(cells.points().view(), cells.triangulation(), region...,
                               cells.weights(), clipping(options, shapes, diagram)));
  });
}
std::unique_ptr<ClippedCells> clip_to_box(const Cells& cells, const Voronoi& diagram,
                                          const std::vector<double>& low,
                                          const std::vector<double>& high, bool shapes,
                                          const Settings* settings) {
  return clip(cells, diagram, shapes, settings, low, high);
}
std::unique_ptr<ClippedCells> clip_to_hull(const Cells& cells, const Voronoi& diagram,
                                           nb::handle array, bool shapes,
                                           const Settings* settings) {
  return clip(cells, diagram, shapes, settings, Points(array).view());
}
/// `offsets`: rings + 1 into the corners.
std::unique_ptr<ClippedCells> clip_to_polygons(const Cells& cells, const Voronoi& diagram,
                                               nb::handle array,
                                               const std::vector<std::uint64_t>& offsets,
                                               bool shapes, const Settings* settings) {
  const Points corners(array);
  return clip(cells, diagram, shapes, settings, corners.view(), offsets);
}

using Integers = nb::typed<nb::list, int>;
using IntegerLists = nb::typed<nb::list, Integers>;

/// Python's list of `count` lists of int, of which `list_at(i)` gives the i-th. `numbers`: the
/// integers 0, 1, ..., which the lists share; those that it lacks are made anew.
template <class ListAt>
IntegerLists nested(std::size_t count, const nb::list& numbers, const ListAt& list_at) {
  const auto known = static_cast<std::int32_t>(
      std::min<std::size_t>(numbers.size(), std::numeric_limits<std::int32_t>::max()));
  const auto item = [&](std::int32_t number) {
    if (number < 0 || number >= known) return PyLong_FromLong(number);
    PyObject* const shared = PyList_GetItem(numbers.ptr(), number);
    Py_XINCREF(shared);
    return shared;
  };
  const auto list_of_length = [](std::size_t length) {
    PyObject* const list = PyList_New(static_cast<Py_ssize_t>(length));
    if (list == nullptr) throw nb::python_error();
    return nb::steal<nb::list>(list);
  };
  // A list that is not complete has null pointers, which its destruction allows for.
  const auto put = [](const nb::list& list, std::size_t at, PyObject* owned) {
    if (owned == nullptr || PyList_SetItem(list.ptr(), static_cast<Py_ssize_t>(at), owned) != 0)
      throw nb::python_error();
  };
  nb::list result = list_of_length(count);
  for (std::size_t i = 0; i < count; ++i) {
    const std::span<const std::int32_t> items = list_at(i);
    nb::list own = list_of_length(items.size());
    for (std::size_t j = 0; j < items.size(); ++j) put(own, j, item(items[j]));
    put(result, i, own.release().ptr());
  }
  return nb::steal<IntegerLists>(result.release());
}

/// Nested lists of numbers; `items` stores them end to end.
IntegerLists nested_lists(Array<std::int64_t> offsets, Array<std::int32_t> items,
                          const Integers& numbers) {
  if (!offsets.is_list() || !items.is_list() || offsets.size() == 0)
    throw nb::value_error("numbers must lie one after another");
  return nested(offsets.size() - 1, numbers, [&](std::size_t i) {
    const auto begin = static_cast<std::uint64_t>(offsets.data()[i]),
               end = static_cast<std::uint64_t>(offsets.data()[i + 1]);
    if (begin > end || end > items.size()) throw nb::value_error("offsets must ascend");
    return std::span<const std::int32_t>(items.data() + begin, items.data() + end);
  });
}

/// As SciPy has a diagram's ridges, or its regions.
IntegerLists lists_of_diagram(const cullhull::Lists<std::uint32_t>& lists,
                              const nb::list& numbers) {
  return nested(lists.size(), numbers, [&](std::size_t i) {
    const auto list = lists[i];
    return std::span(reinterpret_cast<const std::int32_t*>(list.data()), list.size());
  });
}

/// Its own, writable.
template <class T, class List>
Array<T> copied_rows(const List& list, std::size_t width) {
  Array<T> rows = Array<T>::make({width == 0 ? 0 : list.size() / width, width});
  std::copy_n(reinterpret_cast<const T*>(list.data()), list.size(), rows.data());
  return rows;
}

void bind_diagram(nb::module_& m) {
  nb::class_<Voronoi>(m, "Diagram", "A diagram: cullhull.VoronoiDiagram wraps it.")
      .def_prop_ro(
          "vertices",
          [](Self self) { return rows_in(shown(self).vertices, shown(self).dimension, self); })
      .def_prop_ro(
          "ridge_points",
          [](Self self) {
    return rows_of(reinterpret_cast<const std::int32_t*>(shown(self).ridge_points.data()),
                   shown(self).ridge_count(), 2, self);
          })
      .def_prop_ro("ridge_offsets",
                   [](Self self) { return offsets_in(shown(self).ridges.offsets, self); })
      .def_prop_ro("ridge_vertices",
                   [](Self self) { return numbers_in(shown(self).ridges.items, self); })
      .def_prop_ro("region_offsets",
                   [](Self self) { return offsets_in(shown(self).regions.offsets, self); })
      .def_prop_ro("region_vertices",
                   [](Self self) { return numbers_in(shown(self).regions.items, self); })
      .def("scipy_vertices",
           [](const Voronoi& v) { return copied_rows<double>(v.vertices, v.dimension); })
      .def("scipy_ridge_points",
           [](const Voronoi& v) { return copied_rows<std::int32_t>(v.ridge_points, 2); })
      .def(
          "ridge_lists",
          [](const Voronoi& v, const Integers& numbers) {
    return lists_of_diagram(v.ridges, numbers);
          },
          nb::arg("numbers"))
      .def(
          "region_lists",
          [](const Voronoi& v, const Integers& numbers) {
    return lists_of_diagram(v.regions, numbers);
          },
          nb::arg("numbers"))
      .def_prop_ro("ray_vertices",
                   [](Self self) { return numbers_in(shown(self).ray_vertices, self); })
      .def_prop_ro("ray_directions", [](Self self) {
        return rows_in(shown(self).ray_directions, shown(self).dimension, self);
      });
}

void bind_clipped_cells(nb::module_& m) {
  using Clipped = ClippedSelf;
  nb::class_<ClippedCells>(m, "ClippedCells", "Cells in a region: cullhull.ClippedCells wraps it.")
      .def_prop_ro(
          "measures",
          [](Clipped self) {
    const auto& measures = shown_cells(self).measures;
    return list_of(measures.data(), measures.size(), self);
          })
      .def_prop_ro("vertex_offsets",
                   [](Clipped self) { return offsets_in(shown_cells(self).vertex_offsets, self); })
      .def_prop_ro(
          "vertices",
          [](Clipped self) {
    return rows_in(shown_cells(self).vertices, shown_cells(self).dimension, self);
          })
      .def_prop_ro("polygon_offsets",
                   [](Clipped self) { return offsets_in(shown_cells(self).polygon_offsets, self); })
      .def_prop_ro("polygon_rings",
                   [](Clipped self) { return offsets_in(shown_cells(self).polygon_rings, self); })
      .def_prop_ro("ring_starts",
                   [](Clipped self) { return offsets_in(shown_cells(self).ring_starts, self); })
      .def_prop_ro("face_offsets",
                   [](Clipped self) { return offsets_in(shown_cells(self).face_offsets, self); })
      .def_prop_ro(
          "face_starts",
          [](Clipped self) {
    static const cullhull::EvenArray<std::uint64_t> none;  // without shapes, and in the plane
    const ClippedCells& cells = shown_cells(self);
    return offsets_in(cells.face_offsets.empty() ? none : cells.faces.offsets, self);
          })
      .def_prop_ro("face_vertices",
                   [](Clipped self) { return numbers_in(shown_cells(self).faces.items, self); })
      .def_prop_ro("neighbours",
                   [](Clipped self) { return numbers_in(shown_cells(self).neighbours, self); });
}

}  // namespace

void bind_voronoi(nb::module_& m) {
  bind_diagram(m);
  bind_clipped_cells(m);
  m.def("nested_lists", nested_lists, nb::arg("offsets"), nb::arg("items"), nb::arg("numbers"));
  m.def("voronoi", voronoi, nb::arg("cells"), nb::arg("settings").none());
  m.def("clip_to_box", clip_to_box, nb::arg("cells"), nb::arg("diagram"), nb::arg("low"),
        nb::arg("high"), nb::arg("shapes"), nb::arg("settings").none());
  m.def("clip_to_polygons", clip_to_polygons, nb::arg("cells"), nb::arg("diagram"),
        nb::arg("corners"), nb::arg("offsets"), nb::arg("shapes"), nb::arg("settings").none());
  m.def("clip_to_hull", clip_to_hull, nb::arg("cells"), nb::arg("diagram"), nb::arg("region"),
        nb::arg("shapes"), nb::arg("settings").none());
}

}  // namespace binding
