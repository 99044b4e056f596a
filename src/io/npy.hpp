// What begins an .npy file.
#pragma once

#include <cstdint>
#include <initializer_list>
#include <string>

#include "cullhull/point_view.hpp"

namespace cullhull::internal {

/// NumPy's word for a scalar type, little-endian: "<f8".
std::string npy_descr(ScalarType type);

/// All that precedes the data of an array in C order.
std::string npy_header(const char* descr, std::initializer_list<std::uint64_t> shape);

}  // namespace cullhull::internal
