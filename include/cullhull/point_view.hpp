// A view over the caller's points: pointer, count, dimension, strides, scalar type.
#pragma once

#include <cstddef>
#include <cstdint>
#include <type_traits>

#pragma GCC visibility push(default)
namespace cullhull {

/// Scalar types that are read in place. A double represents every value of each exactly.
enum class ScalarType : std::uint8_t { f32, f64, i8, u8, i16, u16, i32, u32 };

constexpr std::size_t scalar_size(ScalarType t) noexcept {
  switch (t) {
    case ScalarType::f64:
      return 8;
    case ScalarType::f32:
    case ScalarType::i32:
    case ScalarType::u32:
      return 4;
    case ScalarType::i16:
    case ScalarType::u16:
      return 2;
    default:
      return 1;
  }
}

/// "f64", "u8", ...; static storage.
const char* scalar_name(ScalarType t) noexcept;

template <class T>
constexpr ScalarType scalar_type_of() noexcept {
  if constexpr (std::is_same_v<T, float>) return ScalarType::f32;
  if constexpr (std::is_same_v<T, double>) return ScalarType::f64;
  if constexpr (std::is_same_v<T, std::int8_t>) return ScalarType::i8;
  if constexpr (std::is_same_v<T, std::uint8_t>) return ScalarType::u8;
  if constexpr (std::is_same_v<T, std::int16_t>) return ScalarType::i16;
  if constexpr (std::is_same_v<T, std::uint16_t>) return ScalarType::u16;
  if constexpr (std::is_same_v<T, std::int32_t>) return ScalarType::i32;
  if constexpr (std::is_same_v<T, std::uint32_t>) return ScalarType::u32;
}

/// Non-owning, trivially copyable; the memory must outlive every call that uses the view and must
/// not change during it. Coordinate j of point i is at `data + i * point_stride + j *
/// coordinate_stride` (bytes, any sign, any alignment), so row-major, column-major and strided
/// records (a PLY vertex, say) are all read in place.
struct PointView {
  const std::byte* data = nullptr;
  ScalarType scalar = ScalarType::f64;
  std::uint32_t dimension = 0;
  std::uint64_t count = 0;
  std::ptrdiff_t point_stride = 0;
  std::ptrdiff_t coordinate_stride = 0;

  /// Point by point: x0 y0 z0 x1 y1 z1 ...
  template <class T>
  static PointView row_major(const T* p, std::uint64_t n, std::uint32_t d) noexcept {
    return {reinterpret_cast<const std::byte*>(p),
            scalar_type_of<T>(),
            d,
            n,
            static_cast<std::ptrdiff_t>(d * sizeof(T)),
            static_cast<std::ptrdiff_t>(sizeof(T))};
  }
  /// Coordinate by coordinate: x0 x1 ... y0 y1 ...
  template <class T>
  static PointView column_major(const T* p, std::uint64_t n, std::uint32_t d) noexcept {
    return {reinterpret_cast<const std::byte*>(p),
            scalar_type_of<T>(),
            d,
            n,
            static_cast<std::ptrdiff_t>(sizeof(T)),
            static_cast<std::ptrdiff_t>(n * sizeof(T))};
  }

  const std::byte* address(std::uint64_t point, std::uint32_t coordinate) const noexcept {
    return data + static_cast<std::ptrdiff_t>(point) * point_stride +
           static_cast<std::ptrdiff_t>(coordinate) * coordinate_stride;
  }
  /// The exact value. O(1), for single points; too slow for loops over all points.
  double at(std::uint64_t point, std::uint32_t coordinate) const noexcept;

  /// True where points are packed rows of scalars without gaps.
  bool packed_rows() const noexcept {
    const auto s = static_cast<std::ptrdiff_t>(scalar_size(scalar));
    return coordinate_stride == s && point_stride == s * static_cast<std::ptrdiff_t>(dimension);
  }
};

}  // namespace cullhull
#pragma GCC visibility pop
