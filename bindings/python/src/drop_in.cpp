// The arrays of the drop-in class for SciPy's: with its types, and writable.
#include <nanobind/nanobind.h>

#include <algorithm>
#include <limits>

#include "arrays.hpp"
#include "solid.hpp"

namespace binding {

using cullhull::Hull;

namespace {

using Self = SolidHandle;

/// int32 as in SciPy, or int64 where an id needs it.
template <class Ids>
IdArray ids_like_scipys(const Ids& ids, std::initializer_list<std::size_t> shape) {
  const auto fits = [](std::uint64_t id) {
    return id <= static_cast<std::uint64_t>(std::numeric_limits<std::int32_t>::max());
  };
  if (std::all_of(ids.begin(), ids.end(), fits)) return copied<std::int32_t>(ids, shape);
  return copied<std::int64_t>(ids, shape);
}

IdArray vertices(Self self) {
  const Hull& h = hull_in(self);
  return ids_like_scipys(h.vertices, {h.vertices.size()});
}

IdArray simplices(Self self) {
  const Hull& h = hull_in(self);
  return ids_like_scipys(h.simplices, {h.simplex_count(), simplex_width(h)});
}

Array<std::int32_t> neighbors(Self self) {
  const Hull& h = hull_in(self);
  check_numbers(h.simplex_count());
  return copied<std::int32_t>(h.simplex_neighbours, {h.simplex_count(), simplex_width(h)});
}

/// Each simplex with the plane of its facet.
Array<double> equations(Self self) {
  const Hull& h = hull_in(self);
  const std::size_t width = std::size_t{h.dimension} + 1, count = h.simplex_count();
  if (h.facet_count() == count)  // in order, as facets are numbered by their first simplex
    return copied<double>(h.facet_planes, {count, width});
  Array<double> all = Array<double>::make({count, width});
  for (std::size_t i = 0; i < count; ++i)
    std::copy_n(h.facet_planes.data() + h.simplex_facets[i] * width, width, all.data() + i * width);
  return all;
}

}  // namespace

void bind_drop_in(nb::class_<Solid>& c) {
  c.def("scipy_vertices", vertices)
      .def("scipy_simplices", simplices)
      .def("scipy_neighbors", neighbors)
      .def("scipy_equations", equations);
}

}  // namespace binding
