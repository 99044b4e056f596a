#include "cullhull/point_view.hpp"

#include <cstring>

#include "parallel/dispatch.hpp"

namespace cullhull {

const char* scalar_name(ScalarType t) noexcept {
  static constexpr const char* names[] = {"f32", "f64", "i8", "u8", "i16", "u16", "i32", "u32"};
  return names[static_cast<unsigned>(t)];
}

double PointView::at(std::uint64_t point, std::uint32_t coordinate) const noexcept {
  const std::byte* p = address(point, coordinate);
  return internal::with_scalar(scalar, [p](auto v) noexcept {
    std::memcpy(&v, p, sizeof v);  // any alignment
    return static_cast<double>(v);
  });
}

}  // namespace cullhull
