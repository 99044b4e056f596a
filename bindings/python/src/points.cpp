#include "points.hpp"

#include <cstring>
#include <limits>
#include <optional>

#include "numpy_api.hpp"

namespace binding {

namespace nb = nanobind;
using cullhull::PointView;
using cullhull::ScalarType;

namespace {

/// By size, because C has several integer types of 32 bits.
std::optional<ScalarType> scalar_of(int type, std::size_t size) {
  if (type == NPY_FLOAT64) return ScalarType::f64;
  if (type == NPY_FLOAT32) return ScalarType::f32;
  if (!PyTypeNum_ISINTEGER(type) && !PyTypeNum_ISBOOL(type)) return std::nullopt;
  const bool is_signed = PyTypeNum_ISSIGNED(type);
  if (size == 1) return is_signed ? ScalarType::i8 : ScalarType::u8;
  if (size == 2) return is_signed ? ScalarType::i16 : ScalarType::u16;
  if (size == 4) return is_signed ? ScalarType::i32 : ScalarType::u32;
  return std::nullopt;
}

template <class T>
void load(const PointView& view, double* to) {
  for (std::uint64_t i = 0; i < view.count; ++i) {
    const std::byte* at = view.data + static_cast<std::ptrdiff_t>(i) * view.point_stride;
    for (unsigned j = 0; j < view.dimension; ++j, at += view.coordinate_stride) {
      T value;
      std::memcpy(&value, at, sizeof value);
      *to++ = static_cast<double>(value);
    }
  }
}

}  // namespace

Points::Points(nb::handle points) : owner_(nb::borrow(points)) {
  if (!PyArray_Check(points.ptr())) throw nb::type_error("points must be a NumPy array");
  auto* const array = reinterpret_cast<PyArrayObject*>(points.ptr());
  const std::optional<ScalarType> scalar =
      scalar_of(PyArray_TYPE(array), static_cast<std::size_t>(PyArray_ITEMSIZE(array)));
  if (!scalar || !PyArray_ISNOTSWAPPED(array))
    throw nb::type_error("points of this type cannot be read in place");
  if (PyArray_NDIM(array) != 2)
    throw nb::value_error("points must be a 2-D array (points, coordinates)");
  const npy_intp* const shape = PyArray_DIMS(array);
  if (shape[1] > static_cast<npy_intp>(std::numeric_limits<std::uint32_t>::max()))
    throw nb::value_error("too many coordinates");
  view_.data = static_cast<const std::byte*>(PyArray_DATA(array));
  view_.scalar = *scalar;
  view_.count = static_cast<std::uint64_t>(shape[0]);
  view_.dimension = static_cast<std::uint32_t>(shape[1]);
  view_.point_stride = PyArray_STRIDES(array)[0];
  view_.coordinate_stride = PyArray_STRIDES(array)[1];
}

std::vector<double> rows_of_view(const PointView& view) {
  std::vector<double> rows(view.count * view.dimension);
  switch (view.scalar) {
    case ScalarType::f32:
      load<float>(view, rows.data());
      break;
    case ScalarType::f64:
      load<double>(view, rows.data());
      break;
    case ScalarType::i8:
      load<std::int8_t>(view, rows.data());
      break;
    case ScalarType::u8:
      load<std::uint8_t>(view, rows.data());
      break;
    case ScalarType::i16:
      load<std::int16_t>(view, rows.data());
      break;
    case ScalarType::u16:
      load<std::uint16_t>(view, rows.data());
      break;
    case ScalarType::i32:
      load<std::int32_t>(view, rows.data());
      break;
    case ScalarType::u32:
      load<std::uint32_t>(view, rows.data());
      break;
  }
  return rows;
}

}  // namespace binding
