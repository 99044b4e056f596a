// Points in a device's memory: __cuda_array_interface__ and DLPack.
#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/unique_ptr.h>

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "arrays.hpp"
#include "cullhull/device_points.hpp"
#include "device_points.hpp"
#include "solid.hpp"

namespace binding {

using cullhull::CudaStatus;
using cullhull::Hull;
using cullhull::Options;
using cullhull::ScalarType;

namespace {

/// The fields of the interface; strides and all in bytes.
DevicePoints from_interface(std::uintptr_t data, std::uint64_t count, std::uint32_t dimension,
                            std::ptrdiff_t point_stride, std::ptrdiff_t coordinate_stride,
                            bool is_double, std::uintptr_t stream, nb::object owner) {
  DevicePoints points;
  points.view.data = reinterpret_cast<const void*>(data);
  points.view.scalar = is_double ? ScalarType::f64 : ScalarType::f32;
  points.view.count = count;
  points.view.dimension = dimension;
  points.view.point_stride = point_stride;
  points.view.coordinate_stride = coordinate_stride;
  points.view.stream = reinterpret_cast<void*>(stream);
  points.owner = std::move(owner);
  return points;
}

/// A DLPack capsule whose producer was asked to order its work before `stream`; null: its work is
/// done. Points, or sets of them, shape (sets, n, d), that follow one another at equal steps.
DevicePoints from_dlpack(const nb::object& capsule, nb::object owner, const DeviceStream* stream) {
  const auto array = nb::cast<nb::ndarray<nb::ro>>(capsule);
  const bool is_double = array.dtype() == nb::dtype<double>();
  if (!is_double && array.dtype() != nb::dtype<float>())
    throw nb::builtin_exception(nb::exception_type::type_error,
                                "points on a device must be float32 or float64");
  if (array.ndim() != 2 && array.ndim() != 3)
    throw nb::value_error("`points` should be a 2D array, or a 3D array of sets");
  const auto size = static_cast<std::ptrdiff_t>(is_double ? sizeof(double) : sizeof(float));
  const bool many = array.ndim() == 3;
  const std::size_t last = array.ndim() - 1;
  const std::uint64_t sets = many ? array.shape(0) : 1, each = array.shape(last - 1);
  if (many && sets > 1 && each > 0 &&
      array.stride(0) != static_cast<std::int64_t>(each) * array.stride(1))
    throw nb::value_error("sets of points on a device must follow one another at equal steps");
  // Keeps the producer's memory; a cast of `array` would be a copy of it, which nanobind refuses.
  nb::capsule keep(new nb::ndarray<nb::ro>(array),
                   [](void* kept) noexcept { delete static_cast<nb::ndarray<nb::ro>*>(kept); });
  DevicePoints points = from_interface(
      reinterpret_cast<std::uintptr_t>(array.data()), sets * each,
      static_cast<std::uint32_t>(array.shape(last)), array.stride(last - 1) * size,
      array.stride(last) * size, is_double, 0, nb::make_tuple(std::move(owner), std::move(keep)));
  if (stream != nullptr) points.stream = stream->stream;
  points.view.stream = points.stream.get();
  if (many) {
    points.sets = static_cast<std::int64_t>(sets);
    points.set_size = static_cast<std::int64_t>(each);
  }
  return points;
}

std::unique_ptr<Solid> convex_hull(const DevicePoints& points, const Settings* settings) {
  return computed(settings, Length::long_, [&](const Options& options) {
    std::vector<double> rows;
    Hull hull = cullhull::convex_hull(points.view, options, &rows);
    return std::make_unique<Solid>(std::move(hull), std::move(rows));
  });
}

Array<std::int64_t> cull(const DevicePoints& points, const Settings* settings) {
  return computed(
             settings, Length::long_,
             [&](const Options& options) {
    return kept_ids(cullhull::cull(points.view, options), points.view.count);
             })
      .to_array();
}

nb::typed<nb::dict, nb::str, nb::any> cuda_status() {
  CudaStatus status;
  {
    const nb::gil_scoped_release release;
    status = cullhull::cuda_status();
  }
  nb::typed<nb::dict, nb::str, nb::any> all;
  all["compiled"] = status.compiled;
  all["available"] = status.available;
  all["reason"] = status.reason;
  all["device"] = status.device;
  all["compute_capability"] = status.compute_capability;
  all["driver_version"] = status.driver_version;
  all["runtime_version"] = status.runtime_version;
  all["memory_bytes"] = status.memory_bytes;
  return all;
}

}  // namespace

void bind_device(nb::module_& m) {
  nb::class_<DeviceStream>(m, "DeviceStream", "A stream of the library's on a device.")
      .def(
          "__init__",
          [](DeviceStream* self, int device) {
    const nb::gil_scoped_release release;
    new (self) DeviceStream{cullhull::device_stream(device)};
          },
          nb::arg("device"))
      .def_prop_ro("handle", [](const DeviceStream& s) {
        return reinterpret_cast<std::uintptr_t>(s.stream.get());
      });
  nb::class_<DevicePoints>(m, "DevicePoints", "Points in a device's memory, and their owner.")
      .def_prop_ro(
          "data",
          [](const DevicePoints& p) { return reinterpret_cast<std::uintptr_t>(p.view.data); })
      .def_prop_ro("sets", [](const DevicePoints& p) { return p.sets; })
      .def_prop_ro("set_size", [](const DevicePoints& p) { return p.set_size; })
      .def_prop_ro("dimension", [](const DevicePoints& p) { return p.view.dimension; })
      .def_static("from_interface", from_interface, nb::arg("data"), nb::arg("count"),
                  nb::arg("dimension"), nb::arg("point_stride"), nb::arg("coordinate_stride"),
                  nb::arg("is_double"), nb::arg("stream"), nb::arg("owner"))
      .def_static("from_dlpack", from_dlpack, nb::arg("capsule"), nb::arg("owner"),
                  nb::arg("stream").none() = nb::none());
  m.def("convex_hull_of_device_points", convex_hull, nb::arg("points"), nb::arg("settings").none());
  m.def("cull_device_points", cull, nb::arg("points"), nb::arg("settings").none());
  m.def("cuda_status", cuda_status);
  // On the calling thread, as the per-thread default stream belongs to it.
  m.def(
      "wait_for_cuda_stream",
      [](std::uintptr_t stream) {
    const nb::gil_scoped_release release;
    cullhull::wait_for_cuda_stream(reinterpret_cast<void*>(stream));
      },
      nb::arg("stream"));
  m.def(
      "wait_for_cuda_device_of",
      [](std::uintptr_t memory) {
    const nb::gil_scoped_release release;
    cullhull::wait_for_cuda_device_of(reinterpret_cast<const void*>(memory));
      },
      nb::arg("memory"));
}

}  // namespace binding
