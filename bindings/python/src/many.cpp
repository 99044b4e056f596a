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

void bind_batch(nb::module_& m) {
  nb::class_<Batch> c(m, "Batch", "Many hulls: cullhull.HullBatch wraps it.");
  c.def("__len__", [](const Batch& b) { return b.hulls.size(); });
  c.def("solid", &Batch::at, nb::arg("set"));
  c.def_prop_ro("dimension", [](const Batch& b) { return b.hulls.dimension; });
  c.def_prop_ro("vertex_points", [](Self self) {
    const Batch& b = batch_in(self);
    return rows_of(b.vertex_rows.data(), b.hulls.vertices.items.size(), b.hulls.dimension, self);
  });
  const auto list = [&](const char* name, auto of) {
    c.def_prop_ro(name, [of](Self self) { return list_in(*of(batch_in(self).hulls), self); });
  };
  list("point_counts", [](const HullBatch& h) { return &h.point_counts; });
  list("affine_dimensions", [](const HullBatch& h) { return &h.affine_dimensions; });
  list("volumes", [](const HullBatch& h) { return &h.volumes; });
  list("areas", [](const HullBatch& h) { return &h.areas; });
  list("vertex_offsets", [](const HullBatch& h) { return &h.vertices.offsets; });
  list("vertices", [](const HullBatch& h) { return &h.vertices.items; });
  list("facet_starts", [](const HullBatch& h) { return &h.facet_starts; });
  list("simplex_offsets", [](const HullBatch& h) { return &h.simplices.offsets; });
  list("simplices", [](const HullBatch& h) { return &h.simplices.items; });
  c.def_prop_ro("centroids", [](Self self) {
    const HullBatch& h = batch_in(self).hulls;
    return rows_of(h.centroids.data(), h.size(), h.dimension, self);
  });
  c.def_prop_ro("facet_planes", [](Self self) {
    const HullBatch& h = batch_in(self).hulls;
    return rows_of(h.facet_planes.data(), h.facets.size(), std::size_t{h.dimension} + 1, self);
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
    std::vector<std::uint64_t> ids = hull.vertices;
    std::sort(ids.begin(), ids.end());
    const auto rows = cullhull::PointView::row_major(growing_.vertex_coordinates().data(),
                                                     ids.size(), hull.dimension);
    return std::make_unique<Solid>(hull, ids, rows);
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
