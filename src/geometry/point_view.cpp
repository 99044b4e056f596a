#include "cullhull/point_view.hpp"

#include <cstring>

namespace cullhull {
namespace {

template <class T>
double load(const std::byte* p) noexcept {
  T v;
  std::memcpy(&v, p, sizeof v);  // any alignment
  return static_cast<double>(v);
}

}  // namespace

const char* scalar_name(ScalarType t) noexcept {
  static constexpr const char* names[] = {"f32", "f64", "i8", "u8", "i16", "u16", "i32", "u32"};
  return names[static_cast<unsigned>(t)];
}

double PointView::at(std::uint64_t point, std::uint32_t coordinate) const noexcept {
  const std::byte* p = address(point, coordinate);
  switch (scalar) {
    case ScalarType::f32:
      return load<float>(p);
    case ScalarType::f64:
      return load<double>(p);
    case ScalarType::i8:
      return load<std::int8_t>(p);
    case ScalarType::u8:
      return load<std::uint8_t>(p);
    case ScalarType::i16:
      return load<std::int16_t>(p);
    case ScalarType::u16:
      return load<std::uint16_t>(p);
    case ScalarType::i32:
      return load<std::int32_t>(p);
    case ScalarType::u32:
      return load<std::uint32_t>(p);
  }
  return 0;
}

}  // namespace cullhull
