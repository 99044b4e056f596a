// The headers of .npy files.
#pragma once

#include <cstdint>
#include <initializer_list>
#include <string>

#include "cullhull/point_view.hpp"

namespace cullhull::internal::inline io {

/// NumPy's word for a scalar type, little-endian: "<f8".
std::string npy_descr(ScalarType type);

/// The header of an array in C order.
std::string npy_header(const char* descr, std::initializer_list<std::uint64_t> shape);

}  // namespace cullhull::internal::inline io
