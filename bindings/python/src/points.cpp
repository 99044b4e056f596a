#include "points.hpp"

#include <cstring>
#include <limits>
#include <optional>
#include <string>

namespace binding {

namespace nb = nanobind;
using cullhull::ScalarType;

namespace {

/// `format` as the struct module writes it: one letter, native byte order.
std::optional<ScalarType> scalar_of(const char* format, Py_ssize_t size) {
  if (format == nullptr) return ScalarType::u8;  // unsigned bytes, by the buffer protocol
  if (std::strchr("@=<", *format) != nullptr && *format != '\0') ++format;
  if (std::strlen(format) != 1) return std::nullopt;
  const bool is_signed = std::strchr("bhilq", *format) != nullptr;
  const bool is_unsigned = std::strchr("?BHILQ", *format) != nullptr;
  if (*format == 'f' && size == 4) return ScalarType::f32;
  if (*format == 'd' && size == 8) return ScalarType::f64;
  if (!is_signed && !is_unsigned) return std::nullopt;
  if (size == 1) return is_signed ? ScalarType::i8 : ScalarType::u8;
  if (size == 2) return is_signed ? ScalarType::i16 : ScalarType::u16;
  if (size == 4) return is_signed ? ScalarType::i32 : ScalarType::u32;
  return std::nullopt;
}

}  // namespace

Points::Points(nb::handle array) {
  if (PyObject_GetBuffer(array.ptr(), &buffer_, PyBUF_RECORDS_RO) != 0) throw nb::python_error();
  const auto refuse = [this](nb::exception_type type, const std::string& why) {
    PyBuffer_Release(&buffer_);
    throw nb::builtin_exception(type, why.c_str());
  };
  const std::optional<ScalarType> scalar = scalar_of(buffer_.format, buffer_.itemsize);
  if (!scalar)
    refuse(nb::exception_type::type_error,
           std::string("points of buffer format '") + buffer_.format + "' cannot be read in place");
  if (buffer_.ndim != 2)
    refuse(nb::exception_type::value_error, "points must be a 2-D array (points, coordinates)");
  if (buffer_.shape[1] > std::numeric_limits<std::uint32_t>::max())
    refuse(nb::exception_type::value_error, "too many coordinates");
  view_.data = static_cast<const std::byte*>(buffer_.buf);
  view_.scalar = *scalar;
  view_.count = static_cast<std::uint64_t>(buffer_.shape[0]);
  view_.dimension = static_cast<std::uint32_t>(buffer_.shape[1]);
  view_.point_stride = buffer_.strides[0];
  view_.coordinate_stride = buffer_.strides[1];
}

}  // namespace binding
