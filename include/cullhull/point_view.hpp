// A view over the caller's points: pointer, count, dimension, strides, scalar type.
#pragma once

#include <array>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <ranges>
#include <type_traits>

#include "cullhull/error.hpp"

#pragma GCC visibility push(default)
namespace cullhull::inline v1 {

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
  static_assert(
      !std::is_integral_v<T> || sizeof(T) <= 4,
      "cullhull takes integers of at most 32 bits, because not every 64-bit integer is a "
      "double: convert the points to double (exact up to 2^53 in magnitude) or to int32_t");
  static_assert(std::is_integral_v<T> || std::is_same_v<T, float> || std::is_same_v<T, double>,
                "coordinates are float, double or integers of 8, 16 or 32 bits");
  if constexpr (std::is_same_v<T, float>) return ScalarType::f32;
  if constexpr (std::is_same_v<T, double>) return ScalarType::f64;
  if constexpr (std::is_same_v<T, std::int8_t>) return ScalarType::i8;
  if constexpr (std::is_same_v<T, std::uint8_t>) return ScalarType::u8;
  if constexpr (std::is_same_v<T, std::int16_t>) return ScalarType::i16;
  if constexpr (std::is_same_v<T, std::uint16_t>) return ScalarType::u16;
  if constexpr (std::is_same_v<T, std::int32_t>) return ScalarType::i32;
  if constexpr (std::is_same_v<T, std::uint32_t>) return ScalarType::u32;
}

/// A point of D coordinates in a row: std::array<T, D>, T[D], or a vector of Eigen's of a fixed
/// size.
template <class P>
struct PointArray {
  static constexpr std::uint32_t dimension = 0;  // none
};
template <class T, std::size_t D>
struct PointArray<std::array<T, D>> {
  using Scalar = T;
  static constexpr std::uint32_t dimension = D;
};
template <class T, std::size_t D>
struct PointArray<T[D]> {
  using Scalar = std::remove_cv_t<T>;
  static constexpr std::uint32_t dimension = D;
};
template <class V>
concept FixedVector = V::IsVectorAtCompileTime != 0 && V::SizeAtCompileTime > 0 &&
                      sizeof(V) == V::SizeAtCompileTime * sizeof(typename V::Scalar);
template <FixedVector V>
struct PointArray<V> {
  using Scalar = typename V::Scalar;
  static constexpr std::uint32_t dimension = V::SizeAtCompileTime;
};
template <class R>
using PointOf = PointArray<std::remove_cv_t<std::ranges::range_value_t<R>>>;

/// A range whose memory a view can refer to after the call that made the view: not a temporary,
/// unless it is a view itself, as std::span is.
template <class R>
concept ViewableRange = std::ranges::contiguous_range<R> && std::ranges::sized_range<R> &&
    (std::is_lvalue_reference_v<R> || std::ranges::borrowed_range<R>);

/// Points: std::vector<std::array<double, 3>>, std::span<const std::array<float, 2>>,
/// double[8][3], ...
template <class R>
concept PointRange = ViewableRange<R> &&(PointOf<R>::dimension != 0);

/// Points whose memory would be gone after the call that made the view.
template <class R>
concept TemporaryPoints =
    std::ranges::contiguous_range<R> && !ViewableRange<R> && PointOf<R>::dimension != 0;

/// Scalars: std::vector<double>, std::span<const float>, ...
template <class R>
concept ScalarRange = ViewableRange<R> && std::is_arithmetic_v<std::ranges::range_value_t<R>>;

/// A matrix with the members of Eigen's: Matrix, Map, and Ref of them.
template <class M>
concept PointMatrix = requires(const M& m) {
  typename M::Scalar;
  { m.data() } -> std::convertible_to<const typename M::Scalar*>;
  { m.rows() } -> std::convertible_to<std::ptrdiff_t>;
  { m.cols() } -> std::convertible_to<std::ptrdiff_t>;
  { m.innerStride() } -> std::convertible_to<std::ptrdiff_t>;
  { m.outerStride() } -> std::convertible_to<std::ptrdiff_t>;
  { M::IsRowMajor ? 1 : 0 } -> std::convertible_to<int>;
  { M::RowsAtCompileTime + M::ColsAtCompileTime } -> std::convertible_to<int>;
};
/// One that refers to another's memory, as Eigen's blocks do; one that owns its memory.
template <class M>
concept MatrixView = requires {
  typename M::PlainObject;
}
&&!std::same_as<M, typename M::PlainObject>;
template <class M>
concept OwningMatrix = PointMatrix<M> && !MatrixView<M> && requires(M & m) {
  m.resize(0, 0);
};

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

  constexpr PointView() noexcept = default;
  constexpr PointView(const std::byte* data_, ScalarType scalar_, std::uint32_t dimension_,
                      std::uint64_t count_, std::ptrdiff_t point_stride_,
                      std::ptrdiff_t coordinate_stride_) noexcept
      : data(data_),
        scalar(scalar_),
        dimension(dimension_),
        count(count_),
        point_stride(point_stride_),
        coordinate_stride(coordinate_stride_) {}

  /// A range of points converts, so it can be passed wherever a view is taken.
  template <PointRange R>
  PointView(R&& points) noexcept  // NOLINT: a range converts
      : PointView(row_major(
            reinterpret_cast<const typename PointOf<R>::Scalar*>(std::ranges::data(points)),
            std::ranges::size(points), PointOf<R>::dimension)) {}

  template <TemporaryPoints R>
  PointView(R&& points) = delete;  // a temporary, whose memory would be gone: give it a name

  /// A matrix of Eigen's converts, too. The points are its columns if the number of rows alone is
  /// known at compile time (Matrix3Xd), else its rows (MatrixX3d, MatrixXd).
  template <PointMatrix M>
  PointView(const M& points) noexcept  // NOLINT: a matrix converts
      : PointView(of_matrix(points)) {}
  template <OwningMatrix M>
  PointView(M&& points) = delete;  // a temporary, whose memory would be gone: give it a name

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
  /// The same of a range of scalars. Error{invalid_argument} if its size is no multiple of d.
  template <ScalarRange R>
  static PointView row_major(R&& scalars, std::uint32_t d) {
    const std::uint64_t size = std::ranges::size(scalars);
    if (d == 0 || size % d != 0)
      throw Error(ErrorCode::invalid_argument, size, " scalars are no points of dimension ", d);
    return row_major(std::ranges::data(scalars), size / d, d);
  }
  /// Points within objects of your own: `d` scalars in a row, from a member on.
  /// records(vertices, &Vertex::x, 3). Error{invalid_argument} if an object is smaller.
  template <ViewableRange R, class T, class C>
  static PointView records(R&& objects, T C::*first, std::uint32_t d) {
    using Object = std::ranges::range_value_t<R>;
    if (d > sizeof(Object) / sizeof(T))
      throw Error(ErrorCode::invalid_argument, "an object holds fewer than ", d, " scalars");
    const std::uint64_t n = std::ranges::size(objects);
    const T* p = n == 0 ? nullptr : std::addressof(std::ranges::data(objects)->*first);
    return {reinterpret_cast<const std::byte*>(p),
            scalar_type_of<T>(),
            d,
            n,
            static_cast<std::ptrdiff_t>(sizeof(Object)),
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

  /// As the constructor from a matrix.
  template <PointMatrix M>
  static PointView of_matrix(const M& m) noexcept {
    const bool by_column = M::RowsAtCompileTime > 0 && M::ColsAtCompileTime <= 0;
    const auto size = static_cast<std::ptrdiff_t>(sizeof(typename M::Scalar));
    const std::ptrdiff_t inner = size * m.innerStride(), outer = size * m.outerStride();
    const bool inner_is_column = M::IsRowMajor;
    return {reinterpret_cast<const std::byte*>(m.data()),
            scalar_type_of<typename M::Scalar>(),
            static_cast<std::uint32_t>(by_column ? m.rows() : m.cols()),
            static_cast<std::uint64_t>(by_column ? m.cols() : m.rows()),
            by_column == inner_is_column ? inner : outer,
            by_column == inner_is_column ? outer : inner};
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

}  // namespace cullhull::inline v1
#pragma GCC visibility pop
