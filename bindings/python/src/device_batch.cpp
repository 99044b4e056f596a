// Batches of points in a device's memory, and hulls that stay there.
#include "cullhull/device_batch.hpp"

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/unique_ptr.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "arrays.hpp"
#include "batch.hpp"
#include "cullhull/device_hull.hpp"
#include "device_items.hpp"
#include "device_points.hpp"
#include "solid.hpp"
#include "statistics.hpp"

namespace binding {

using cullhull::DeviceHull;
using cullhull::DeviceHullBatch;
using cullhull::Options;

namespace {

nb::ndarray<> dlpack(nb::handle_t<DeviceItems> self) {
  const DeviceItems& items = *nb::inst_ptr<DeviceItems>(self);
  return nb::ndarray<>(const_cast<void*>(items.data), items.shape.size(), items.shape.data(), self,
                       nullptr, items.dtype, nb::device::cuda::value, items.device);
}

/// The offsets that Python hands in: an array of the host, or an address on a device.
class Offsets {
 public:
  Offsets(nb::handle array, std::uintptr_t address, std::uint64_t count)
      : data_(reinterpret_cast<const std::uint64_t*>(address)), count_(count) {
    if (!array.is_none()) {
      auto here = nb::cast<Array<std::int64_t>>(array);
      data_ = reinterpret_cast<const std::uint64_t*>(here.data());
      count_ = here.size();
      here_ = std::move(here);
    }
    if (count_ == 0) throw nb::value_error("offsets must be at least one");
  }
  const std::uint64_t* data() const { return data_; }
  std::uint64_t sets() const { return count_ - 1; }

 private:
  nb::object here_;
  const std::uint64_t* data_;
  std::uint64_t count_;
};

/// `array`: contiguous int64, or None for `count` numbers at an address on a device.
std::unique_ptr<Batch> convex_hulls(const DevicePoints& points, nb::handle array,
                                    std::uintptr_t address, std::uint64_t count,
                                    const Settings* settings) {
  const Offsets offsets(array, address, count);
  auto batch = std::make_unique<Batch>();
  run(settings, Length::long_, [&](const Options& options) {
    batch->hulls = cullhull::convex_hulls(points.view, offsets.data(), offsets.sets(), options,
                                          &batch->vertex_rows);
  });
  return batch;
}

/// `most_vertices`, `most_simplices`: the sizes of padded rows; 0: the largest hull's.
DeviceHullBatch convex_hulls_on_device(const DevicePoints& points, nb::handle array,
                                       std::uintptr_t address, std::uint64_t count, bool planes,
                                       bool measures, bool padded, std::uint64_t most_vertices,
                                       std::uint64_t most_simplices, const Settings* settings) {
  const Offsets offsets(array, address, count);
  DeviceHullBatch batch;
  run(settings, Length::long_, [&](const Options& options) {
    batch = cullhull::convex_hulls_on_device(points.view, offsets.data(), offsets.sets(), options,
                                             {.planes = planes,
                                              .measures = measures,
                                              .padded = padded,
                                              .most_vertices = most_vertices,
                                              .most_simplices = most_simplices});
  });
  batch.memory = freed_without_gil(std::move(batch.memory));
  return batch;
}

template <class T>
DeviceItems items_of(const DeviceHullBatch& b, const T* data, std::vector<std::size_t> shape) {
  return {data, std::move(shape), nb::dtype<T>(), b.device, b.memory};
}

bool padded(const DeviceHullBatch& b) { return b.vertex_offsets == nullptr; }

/// Throws AttributeError, with a reason, where the call did not ask for an array.
void require(bool given, const char* otherwise) {
  if (!given) throw nb::attribute_error(otherwise);
}
constexpr const char* end_to_end = "the batch is padded: see vertex_counts and simplex_counts";
constexpr const char* in_rows = "the batch is not padded: see vertex_offsets and simplex_offsets";
constexpr const char* no_measures = "measures were not asked for: measures=True";

/// The shape of an array with `length` numbers for each simplex.
std::vector<std::size_t> simplex_shape(const DeviceHullBatch& b, std::size_t length) {
  if (padded(b)) return {b.sets, b.simplex_width, length};
  return {b.simplex_count, length};
}

DeviceItems vertices(const DeviceHullBatch& b) {
  if (padded(b)) return items_of(b, b.vertices, {b.sets, b.vertex_width});
  return items_of(b, b.vertices, {b.vertex_count});
}
DeviceItems simplices(const DeviceHullBatch& b) {
  return items_of(b, b.simplices, simplex_shape(b, b.dimension));
}
DeviceItems vertex_offsets(const DeviceHullBatch& b) {
  require(!padded(b), end_to_end);
  return items_of(b, b.vertex_offsets, {b.sets + 1});
}
DeviceItems simplex_offsets(const DeviceHullBatch& b) {
  require(!padded(b), end_to_end);
  return items_of(b, b.simplex_offsets, {b.sets + 1});
}
DeviceItems vertex_counts(const DeviceHullBatch& b) {
  require(padded(b), in_rows);
  return items_of(b, b.vertex_counts, {b.sets});
}
DeviceItems simplex_counts(const DeviceHullBatch& b) {
  require(padded(b), in_rows);
  return items_of(b, b.simplex_counts, {b.sets});
}
DeviceItems affine_dimensions(const DeviceHullBatch& b) {
  return items_of(b, b.affine_dimensions, {b.sets});
}
DeviceItems planes(const DeviceHullBatch& b) {
  require(b.planes != nullptr, "planes were not asked for: planes=True");
  return items_of(b, b.planes, simplex_shape(b, std::size_t{b.dimension} + 1));
}
DeviceItems volumes(const DeviceHullBatch& b) {
  require(b.volumes != nullptr, no_measures);
  return items_of(b, b.volumes, {b.sets});
}
DeviceItems areas(const DeviceHullBatch& b) {
  require(b.areas != nullptr, no_measures);
  return items_of(b, b.areas, {b.sets});
}
DeviceItems centroids(const DeviceHullBatch& b) {
  require(b.centroids != nullptr, no_measures);
  return items_of(b, b.centroids, {b.sets, b.dimension});
}

/// One hull.
DeviceHull convex_hull_on_device(const DevicePoints& points, const Settings* settings) {
  DeviceHull hull = computed(settings, Length::long_, [&](const Options& options) {
    return cullhull::convex_hull_on_device(points.view, options);
  });
  hull.memory = freed_without_gil(std::move(hull.memory));
  return hull;
}

/// An array with `width` numbers for each simplex.
template <class T>
DeviceItems by_simplex(const DeviceHull& h, const T* data, std::size_t width) {
  return {data, {h.simplex_count, width}, nb::dtype<T>(), h.device, h.memory};
}
std::size_t corners(const DeviceHull& h) {
  return static_cast<std::size_t>(std::max(h.affine_dimension, 0));
}

void bind_device_hull(nb::module_& m) {
  nb::class_<DeviceHull>(m, "DeviceHull", "A hull: cullhull.DeviceHull wraps it.")
      .def_ro("dimension", &DeviceHull::dimension)
      .def_ro("affine_dimension", &DeviceHull::affine_dimension)
      .def_ro("point_count", &DeviceHull::point_count)
      .def_ro("volume", &DeviceHull::volume)
      .def_ro("area", &DeviceHull::area)
      .def_ro("centroid", &DeviceHull::centroid)
      .def_prop_ro("statistics", [](const DeviceHull& h) { return dict_of(h.statistics); })
      .def_prop_ro(
          "vertices",
          [](const DeviceHull& h) {
    return DeviceItems{h.vertices, {h.vertex_count}, nb::dtype<std::int64_t>(), h.device, h.memory};
          })
      .def_prop_ro("simplices",
                   [](const DeviceHull& h) { return by_simplex(h, h.simplices, corners(h)); })
      .def_prop_ro("simplex_neighbours",
                   [](const DeviceHull& h) { return by_simplex(h, h.neighbours, corners(h)); })
      .def_prop_ro("planes", [](const DeviceHull& h) {
        return by_simplex(h, h.planes, std::size_t{h.dimension} + 1);
      });
  m.def("convex_hull_on_device", convex_hull_on_device, nb::arg("points"),
        nb::arg("settings").none());
}

}  // namespace

void bind_device_batch(nb::module_& m) {
  nb::class_<DeviceItems>(m, "DeviceItems", "An array of a result in a device's memory.")
      .def_prop_ro("data",
                   [](const DeviceItems& a) { return reinterpret_cast<std::uintptr_t>(a.data); })
      .def_prop_ro("shape", [](const DeviceItems& a) { return a.shape; })
      .def_prop_ro("typestr", &DeviceItems::typestr)
      .def_prop_ro("device", [](const DeviceItems& a) { return a.device; })
      .def("dlpack", dlpack, nb::sig("def dlpack(self) -> object"));
  nb::class_<DeviceHullBatch>(m, "DeviceBatch", "Hulls: cullhull.DeviceHullBatch wraps it.")
      .def_prop_ro("dimension", [](const DeviceHullBatch& b) { return b.dimension; })
      .def("__len__", [](const DeviceHullBatch& b) { return b.sets; })
      .def_prop_ro("vertices", vertices)
      .def_prop_ro("vertex_offsets", vertex_offsets)
      .def_prop_ro("vertex_counts", vertex_counts)
      .def_prop_ro("simplices", simplices)
      .def_prop_ro("simplex_offsets", simplex_offsets)
      .def_prop_ro("simplex_counts", simplex_counts)
      .def_prop_ro("affine_dimensions", affine_dimensions)
      .def_prop_ro("planes", planes)
      .def_prop_ro("volumes", volumes)
      .def_prop_ro("areas", areas)
      .def_prop_ro("centroids", centroids);
  m.def("convex_hulls_of_device_points", convex_hulls, nb::arg("points"), nb::arg("offsets").none(),
        nb::arg("address"), nb::arg("count"), nb::arg("settings").none());
  m.def("convex_hulls_on_device", convex_hulls_on_device, nb::arg("points"),
        nb::arg("offsets").none(), nb::arg("address"), nb::arg("count"), nb::arg("planes"),
        nb::arg("measures"), nb::arg("padded"), nb::arg("most_vertices"), nb::arg("most_simplices"),
        nb::arg("settings").none());
  bind_device_hull(m);
}

}  // namespace binding
