// Batches of hulls, and hulls that grow.
#include <nanobind/nanobind.h>
#include <nanobind/stl/unique_ptr.h>

#include <algorithm>
#include <atomic>
#include <memory>
#include <utility>
#include <vector>

#include "arrays.hpp"
#include "batch.hpp"
#include "cullhull/growing_hull.hpp"
#include "points.hpp"
#include "solid.hpp"

namespace binding {

using cullhull::GrowingHull;
using cullhull::HullBatch;
using cullhull::Options;

namespace {

/// `offset_array`: contiguous, at least one.
std::unique_ptr<Batch> convex_hulls(nb::handle array, Array<std::int64_t> offset_array,
                                    const Settings* settings) {
  const Points points(array);
  if (offset_array.size() == 0) throw nb::value_error("offsets must be at least one");
  const auto* const offsets = reinterpret_cast<const std::uint64_t*>(offset_array.data());
  auto batch = std::make_unique<Batch>();
  run(settings, length_of(points.view()), [&](const Options& options) {
    batch->hulls = cullhull::convex_hulls(points.view(), {offsets, offset_array.size()}, options);
    batch->gather_vertices(points.view(), offsets);
  });
  return batch;
}

using Self = nb::handle_t<Batch>;
const Batch& batch_in(Self self) { return *nb::inst_ptr<Batch>(self); }

template <class Values>
Array<typename Values::value_type> values(Self self, const Values& list) {
  return list_of(list.data(), list.size(), self);
}

void bind_batch(nb::module_& m) {
  nb::class_<Batch>(m, "Batch", "Many hulls: cullhull.HullBatch wraps it.")
      .def("__len__", [](const Batch& b) { return b.hulls.size(); })
      .def("solid", &Batch::at, nb::arg("set"))
      .def_prop_ro("dimension", [](const Batch& b) { return b.hulls.dimension; })
      .def_prop_ro(
          "point_counts",
          [](Self self) {
    const auto& list = batch_in(self).hulls.point_counts;
    return list_of(signed_ids(list), list.size(), self);
          })
      .def_prop_ro("affine_dimensions",
                   [](Self self) { return values(self, batch_in(self).hulls.affine_dimensions); })
      .def_prop_ro("volumes", [](Self self) { return values(self, batch_in(self).hulls.volumes); })
      .def_prop_ro("areas", [](Self self) { return values(self, batch_in(self).hulls.areas); })
      .def_prop_ro(
          "centroids",
          [](Self self) {
    const HullBatch& h = batch_in(self).hulls;
    return rows_of(h.centroids.data(), h.size(), h.dimension, self);
          })
      .def_prop_ro(
          "vertex_offsets",
          [](Self self) { return signed_list(batch_in(self).hulls.vertices.offsets, self); })
      .def_prop_ro(
          "vertices",
          [](Self self) {
    const auto& list = batch_in(self).hulls.vertices.items;
    return list_of(signed_ids(list), list.size(), self);
          })
      .def_prop_ro(
          "vertex_points",
          [](Self self) {
    const Batch& b = batch_in(self);
    return rows_of(b.vertex_rows.data(), b.hulls.vertices.items.size(), b.hulls.dimension, self);
          })
      .def_prop_ro(
          "facet_starts",
          [](Self self) {
    const auto& list = batch_in(self).hulls.facet_starts;
    return list_of(signed_ids(list), list.size(), self);
          })
      .def_prop_ro(
          "facet_planes",
          [](Self self) {
    const HullBatch& h = batch_in(self).hulls;
    return rows_of(h.facet_planes.data(), h.facets.size(), std::size_t{h.dimension} + 1, self);
          })
      .def_prop_ro(
          "simplex_offsets",
          [](Self self) { return signed_list(batch_in(self).hulls.simplices.offsets, self); })
      .def_prop_ro("simplices", [](Self self) {
        const auto& list = batch_in(self).hulls.simplices.items;
        return list_of(signed_ids(list), list.size(), self);
      });
}

/// A growing hull; not for two threads at once, which is an error rather than a race.
class Grower {
 public:
  explicit Grower(std::uint32_t dimension) : growing_(dimension) {}
  explicit Grower(const Solid& solid) : growing_(solid.hull(), solid.rows_by_place()) {}

  std::uint64_t add(nb::handle array, const Settings* settings) {
    const Points points(array);
    const Busy busy(busy_, adding);
    std::uint64_t outside = 0;
    run(settings,
        std::max(length_of(points.view()),
                 length_of(points.view(), growing_.hull().simplex_count())),
        [&](const Options& options) { outside = growing_.add(points.view(), options); });
    return outside;
  }
  /// A copy of the present hull, which further points do not change.
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
  m.def("convex_hulls", convex_hulls, nb::arg("points"), nb::arg("offsets"),
        nb::arg("settings").none());
  nb::class_<Grower>(m, "Grower", "A growing hull: cullhull.GrowingHull wraps it.")
      .def(nb::init<std::uint32_t>(), nb::arg("dimension"))
      .def(nb::init<const Solid&>(), nb::arg("solid"))
      .def("add", &Grower::add, nb::arg("points"), nb::arg("settings").none())
      .def("solid", &Grower::solid)
      .def_prop_ro("dimension", &Grower::dimension);
}

}  // namespace binding
