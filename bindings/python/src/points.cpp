#include "points.hpp"

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
  double* to = rows.data();
  for (std::uint64_t i = 0; i < view.count; ++i)
    for (unsigned j = 0; j < view.dimension; ++j) *to++ = view.at(i, j);
  return rows;
}

}  // namespace binding
