// Voronoi and power diagrams, whole and within a region.
#include "cullhull/voronoi.hpp"

#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/unique_ptr.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <limits>
#include <memory>
#include <numeric>
#include <optional>
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

using Self = nb::handle_t<Voronoi>;
const Voronoi& shown(Self self) { return *nb::inst_ptr<Voronoi>(self); }
using ClippedSelf = nb::handle_t<ClippedCells>;
const ClippedCells& shown_cells(ClippedSelf self) { return *nb::inst_ptr<ClippedCells>(self); }

std::unique_ptr<Voronoi> voronoi(const Cells& cells, const Settings* settings) {
  auto result = computed(settings, length_of_cells(cells), [&](const Options& options) {
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
  return computed(settings, length_of_cells(cells), [&](const Options& options) {
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

/// For each of `count` points the simplices at it: ascending, or, with the neighbours of triangles,
/// in a ring from the lowest on, counter-clockwise where triangles are so.
IntegerLists simplices_at(Array<std::int32_t> simplices,
                          std::optional<Array<std::int32_t>> neighbours, std::size_t count,
                          std::size_t corners) {
  const std::size_t size = simplices.size();
  if (!simplices.is_contiguous() || corners == 0 || size % corners != 0 ||
      (neighbours && (!neighbours->is_contiguous() || neighbours->size() != size || corners != 3)))
    throw nb::value_error("simplices with a neighbour across each corner");
  const std::vector<std::int32_t> points(simplices.data(), simplices.data() + size);
  std::vector<std::size_t> ends(count + 1), at(size);
  for (const std::int32_t p : points) {
    if (p < 0 || static_cast<std::size_t>(p) >= count) throw nb::index_error();
    ++ends[static_cast<std::size_t>(p) + 1];
  }
  std::partial_sum(ends.begin(), ends.end(), ends.begin());
  std::vector<std::size_t> next = ends;
  for (std::size_t i = 0; i < size; ++i) at[next[static_cast<std::size_t>(points[i])]++] = i;
  std::vector<std::int32_t> ring;
  return nested(count, nb::list(), [&](std::size_t p) {
    ring.clear();
    std::size_t place = ends[p] < ends[p + 1] ? at[ends[p]] : 0;
    for (std::size_t k = ends[p]; k < ends[p + 1]; ++k) {
      if (!neighbours) place = at[k];
      ring.push_back(static_cast<std::int32_t>(place / corners));
      if (!neighbours) continue;
      // Over the edge opposite to the next corner.
      const std::int32_t over = neighbours->data()[place / 3 * 3 + (place + 1) % 3];
      if (over < 0 || static_cast<std::size_t>(over) >= size / 3) throw nb::index_error();
      const auto first = points.begin() + std::ptrdiff_t{3} * over;
      const auto found = std::find(first, first + 3, points[place]);
      if (found == first + 3) throw nb::value_error("a neighbour without the edge");
      place = static_cast<std::size_t>(found - points.begin());
    }
    return std::span<const std::int32_t>(ring);
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

void bind_diagram(nb::module_& m) {
  nb::class_<Voronoi> c(m, "Diagram", "A diagram: cullhull.VoronoiDiagram wraps it.");
  const auto list = [&](const char* name, auto of) {
    c.def_prop_ro(name, [of](Self self) { return list_in(*of(shown(self)), self); });
  };
  list("ridge_offsets", [](const Voronoi& v) { return &v.ridges.offsets; });
  list("ridge_vertices", [](const Voronoi& v) { return &v.ridges.items; });
  list("region_offsets", [](const Voronoi& v) { return &v.regions.offsets; });
  list("region_vertices", [](const Voronoi& v) { return &v.regions.items; });
  list("ray_vertices", [](const Voronoi& v) { return &v.ray_vertices; });
  c.def_prop_ro("vertices", [](Self self) {
    return rows_in(shown(self).vertices, shown(self).dimension, self);
  });
  c.def_prop_ro("ray_directions", [](Self self) {
    return rows_in(shown(self).ray_directions, shown(self).dimension, self);
  });
  c.def_prop_ro("ridge_points",
                [](Self self) { return rows_in(shown(self).ridge_points, 2, self); });
  c.def("scipy_vertices", [](const Voronoi& v) {
    return copied<double>(v.vertices, {v.vertex_count(), v.dimension});
  });
  c.def("scipy_ridge_points", [](const Voronoi& v) {
    return copied<std::int32_t>(v.ridge_points, {v.ridge_count(), 2});
  });
  const auto numbers = nb::arg("numbers");
  c.def(
      "ridge_lists",
      [](const Voronoi& v, const Integers& n) { return lists_of_diagram(v.ridges, n); }, numbers);
  c.def(
      "region_lists",
      [](const Voronoi& v, const Integers& n) { return lists_of_diagram(v.regions, n); }, numbers);
}

void bind_clipped_cells(nb::module_& m) {
  nb::class_<ClippedCells> bound(m, "ClippedCells",
                                 "Cells in a region: cullhull.ClippedCells wraps it.");
  const auto list = [&](const char* name, auto of) {
    bound.def_prop_ro(name,
                      [of](ClippedSelf self) { return list_in(*of(shown_cells(self)), self); });
  };
  list("measures", [](const ClippedCells& c) { return &c.measures; });
  list("vertex_offsets", [](const ClippedCells& c) { return &c.vertex_offsets; });
  list("polygon_offsets", [](const ClippedCells& c) { return &c.polygon_offsets; });
  list("polygon_rings", [](const ClippedCells& c) { return &c.polygon_rings; });
  list("ring_starts", [](const ClippedCells& c) { return &c.ring_starts; });
  list("face_offsets", [](const ClippedCells& c) { return &c.face_offsets; });
  list("face_starts", [](const ClippedCells& c) {
    static const cullhull::EvenArray<std::uint64_t> none;  // without shapes, and in the plane
    return c.face_offsets.empty() ? &none : &c.faces.offsets;
  });
  list("face_vertices", [](const ClippedCells& c) { return &c.faces.items; });
  list("neighbours", [](const ClippedCells& c) { return &c.neighbours; });
  bound.def_prop_ro("vertices", [](ClippedSelf self) {
    return rows_in(shown_cells(self).vertices, shown_cells(self).dimension, self);
  });
}

}  // namespace

void bind_voronoi(nb::module_& m) {
  bind_diagram(m);
  bind_clipped_cells(m);
  m.def("nested_lists", nested_lists, nb::arg("offsets"), nb::arg("items"), nb::arg("numbers"));
  m.def("simplices_at", simplices_at, nb::arg("simplices"), nb::arg("neighbours").none(),
        nb::arg("count"), nb::arg("corners"));
  m.def("voronoi", voronoi, nb::arg("cells"), nb::arg("settings").none());
  m.def("clip_to_box", clip_to_box, nb::arg("cells"), nb::arg("diagram"), nb::arg("low"),
        nb::arg("high"), nb::arg("shapes"), nb::arg("settings").none());
  m.def("clip_to_polygons", clip_to_polygons, nb::arg("cells"), nb::arg("diagram"),
        nb::arg("corners"), nb::arg("offsets"), nb::arg("shapes"), nb::arg("settings").none());
  m.def("clip_to_hull", clip_to_hull, nb::arg("cells"), nb::arg("diagram"), nb::arg("region"),
        nb::arg("shapes"), nb::arg("settings").none());
}

}  // namespace binding
