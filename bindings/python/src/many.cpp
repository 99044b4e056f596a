// Batches of hulls, and hulls that grow.
#include <nanobind/nanobind.h>
#include <nanobind/stl/unique_ptr.h>

#include <algorithm>
#include <atomic>
#include <cstring>
#include <memory>
#include <utility>
#include <vector>

#include "arrays.hpp"
#include "cullhull/batch.hpp"
#include "cullhull/growing_hull.hpp"
#include "points.hpp"
#include "solid.hpp"

namespace binding {

using cullhull::GrowingHull;
using cullhull::HullBatch;
using cullhull::Options;

namespace {

/// The batch and the coordinates of all its vertices.
struct Batch {
  HullBatch hulls;
  cullhull::Array<double> vertex_rows;

  std::unique_ptr<Solid> at(std::size_t i) const {
    const auto row = [&](std::size_t set) {
      return vertex_rows.begin() +
             static_cast<std::ptrdiff_t>(hulls.vertices.offsets[set] * hulls.dimension);
    };
    return std::make_unique<Solid>(hulls.hull(i), std::vector<double>(row(i), row(i + 1)));
  }

  void gather_vertices(const cullhull::PointView& points, const std::uint64_t* sets) {
    const auto& ids = hulls.vertices;
    vertex_rows.resize(ids.items.size() * points.dimension);
    double* out = vertex_rows.data();
    for (std::size_t set = 0; set < hulls.size(); ++set)
      for (std::uint64_t i = ids.offsets[set]; i < ids.offsets[set + 1]; ++i)
        for (std::uint32_t j = 0; j < points.dimension; ++j, ++out) {
          const std::uint64_t point = sets[set] + ids.items[i];
          if (points.scalar == cullhull::ScalarType::f64)
            std::memcpy(out, points.address(point, j), sizeof *out);
          else
            *out = points.at(point, j);
        }
  }
};

/// An array of int64 that ascends, read in place.
class Offsets {
 public:
  explicit Offsets(nb::handle array) {
    if (PyObject_GetBuffer(array.ptr(), &buffer_, PyBUF_ND) != 0) throw nb::python_error();
  }
  Offsets(const Offsets&) = delete;
  Offsets& operator=(const Offsets&) = delete;
  ~Offsets() { PyBuffer_Release(&buffer_); }
  const std::uint64_t* data() const { return static_cast<const std::uint64_t*>(buffer_.buf); }
  std::uint64_t sets() const {
    if (buffer_.itemsize != sizeof(std::uint64_t) || buffer_.ndim != 1 || buffer_.shape[0] < 1)
      throw nb::value_error("offsets must be a list of at least one int64");
    return static_cast<std::uint64_t>(buffer_.shape[0]) - 1;
  }

 private:
  Py_buffer buffer_{};
};

std::unique_ptr<Batch> convex_hulls(nb::handle array, nb::handle offset_array,
                                    const Settings& settings) {
  const Points points(array);
  const Offsets offsets(offset_array);
  const std::uint64_t sets = offsets.sets();
  auto batch = std::make_unique<Batch>();
  run(settings, is_brief(points.view()), [&](const Options& options) {
    batch->hulls = cullhull::convex_hulls(points.view(), offsets.data(), sets, options);
    batch->gather_vertices(points.view(), offsets.data());
  });
  return batch;
}

using Self = nb::handle_t<Batch>;
const Batch& batch_in(Self self) { return *nb::inst_ptr<Batch>(self); }

template <class Values>
ListView<typename Values::value_type> values(Self self, const Values& list) {
  return list_of(list.data(), list.size(), self);
}

void bind_batch(nb::module_& m) {
  nb::class_<Batch>(m, "Batch", "Many hulls: cullhull.HullBatch wraps it.")
      .def("__len__", [](const Batch& b) { return b.hulls.size(); })
      .def("solid", &Batch::at, nb::arg("set"))
      .def_prop_ro("dimension", [](const Batch& b) { return b.hulls.dimension; })
      .def_prop_ro("point_counts",
                   [](Self self) {
                     const auto& list = batch_in(self).hulls.point_counts;
                     return list_of(signed_ids(list), list.size(), self);
                   })
      .def_prop_ro("affine_dimensions",
                   [](Self self) { return values(self, batch_in(self).hulls.affine_dimensions); })
      .def_prop_ro("volumes", [](Self self) { return values(self, batch_in(self).hulls.volumes); })
      .def_prop_ro("areas", [](Self self) { return values(self, batch_in(self).hulls.areas); })
      .def_prop_ro("centroids",
                   [](Self self) {
                     const HullBatch& h = batch_in(self).hulls;
                     return rows_of(h.centroids.data(), h.size(), h.dimension, self);
                   })
      .def_prop_ro(
          "vertex_offsets",
          [](Self self) { return signed_list(batch_in(self).hulls.vertices.offsets, self); },
          nb::rv_policy::reference)
      .def_prop_ro("vertices",
                   [](Self self) {
                     const auto& list = batch_in(self).hulls.vertices.items;
                     return list_of(signed_ids(list), list.size(), self);
                   })
      .def_prop_ro("vertex_points",
                   [](Self self) {
                     const Batch& b = batch_in(self);
                     return rows_of(b.vertex_rows.data(), b.hulls.vertices.items.size(),
                                    b.hulls.dimension, self);
                   })
      .def_prop_ro("facet_starts",
                   [](Self self) {
                     const auto& list = batch_in(self).hulls.facet_starts;
                     return list_of(signed_ids(list), list.size(), self);
                   })
      .def_prop_ro("facet_planes",
                   [](Self self) {
                     const HullBatch& h = batch_in(self).hulls;
                     return rows_of(h.facet_planes.data(), h.facets.size(),
                                    std::size_t{h.dimension} + 1, self);
                   })
      .def_prop_ro(
          "simplex_offsets",
          [](Self self) { return signed_list(batch_in(self).hulls.simplices.offsets, self); },
          nb::rv_policy::reference)
      .def_prop_ro("simplices", [](Self self) {
        const auto& list = batch_in(self).hulls.simplices.items;
        return list_of(signed_ids(list), list.size(), self);
      });
}

/// A growing hull; not for two threads at once, which is an error rather than a race.
class Grower {
 public:
  explicit Grower(std::uint32_t dimension) : growing_(dimension) {}

  std::uint64_t add(nb::handle array, const Settings& settings) {
    const Points points(array);
    const Busy busy(busy_, adding);
    std::uint64_t outside = 0;
    run(settings, is_brief(points.view()) && growing_.hull().simplex_count() <= 4000,
        [&](const Options& options) { outside = growing_.add(points.view(), options); });
    return outside;
  }
  /// The hull as it is now, in a copy that further points do not change.
  std::unique_ptr<Solid> solid() {
    const Busy busy(busy_, adding);
    const cullhull::Hull& hull = growing_.hull();
    const std::vector<double>& by_id = growing_.vertex_coordinates();
    std::vector<std::uint64_t> ids = hull.vertices;
    std::sort(ids.begin(), ids.end());
    std::vector<double> rows;
    rows.reserve(by_id.size());
    for (const std::uint64_t v : hull.vertices) {
      const auto place = std::lower_bound(ids.begin(), ids.end(), v) - ids.begin();
      const auto first = by_id.begin() + place * static_cast<std::ptrdiff_t>(hull.dimension);
      rows.insert(rows.end(), first, first + static_cast<std::ptrdiff_t>(hull.dimension));
    }
    return std::make_unique<Solid>(hull, std::move(rows));
  }
  std::uint32_t dimension() const { return growing_.hull().dimension; }

 private:
  static constexpr const char* adding = "adding points to this hull";
  GrowingHull growing_;
  std::atomic<bool> busy_{false};
};

}  // namespace

void bind_many(nb::module_& m) {
  bind_batch(m);
  m.def("convex_hulls", convex_hulls, nb::arg("points"), nb::arg("offsets"), nb::arg("settings"));
  nb::class_<Grower>(m, "Grower", "A growing hull: cullhull.GrowingHull wraps it.")
      .def(nb::init<std::uint32_t>(), nb::arg("dimension"))
      .def("add", &Grower::add, nb::arg("points"), nb::arg("settings"))
      .def("solid", &Grower::solid)
      .def_prop_ro("dimension", &Grower::dimension);
}

}  // namespace binding
