// A view over the caller's points: pointer, count, dimension, strides, scalar type.
#pragma once

#include <array>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <memory>
#include <ranges>
#include <type_traits>
#include <vector>

#include "cullhull/error.hpp"

// Where a compiler has the attribute, it warns of a view that outlives what it refers to.
#if defined(__clang__)
#define CULLHULL_LIFETIME_BOUND [[clang::lifetimebound]]
#else
#define CULLHULL_LIFETIME_BOUND
#endif

#pragma GCC visibility push(default)
namespace cullhull::internal {

/// A point of D coordinates in a row: std::array<T, D>, T[D], or a vector of Eigen's of a fixed
/// size.
template <class P>
struct PointTraits {
  static constexpr std::uint32_t dimension = 0;  // none
};
template <class T, std::size_t D>
struct PointTraits<std::array<T, D>> {
  using Scalar = T;
  static constexpr std::uint32_t dimension = D;
};
template <class T, std::size_t D>
struct PointTraits<T[D]> {
  using Scalar = std::remove_cv_t<T>;
  static constexpr std::uint32_t dimension = D;
};
template <class V>
concept FixedVector = V::IsVectorAtCompileTime != 0 && V::SizeAtCompileTime > 0 &&
                      sizeof(V) == V::SizeAtCompileTime * sizeof(typename V::Scalar);
template <FixedVector V>
struct PointTraits<V> {
  using Scalar = typename V::Scalar;
  static constexpr std::uint32_t dimension = V::SizeAtCompileTime;
};
template <class R>
using PointOf = PointTraits<std::remove_cv_t<std::ranges::range_value_t<R>>>;

}  // namespace cullhull::internal

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

/// A range whose memory a view can refer to after the call that made the view: not a temporary,
/// unless it is a view itself, as std::span is.
template <class R>
concept ViewableRange = std::ranges::contiguous_range<R> && std::ranges::sized_range<R> &&
    (std::is_lvalue_reference_v<R> || std::ranges::borrowed_range<R>);

/// Points: std::vector<std::array<double, 3>>, std::span<const std::array<float, 2>>,
/// double[8][3], ...
template <class R>
concept PointRange = std::ranges::contiguous_range<R> && std::ranges::sized_range<R> &&
    (internal::PointOf<R>::dimension != 0);

struct PointView;

/// Objects of which a view does not know where their coordinates are.
template <class R>
concept ObjectRange = std::ranges::contiguous_range<R> && internal::PointOf<R>::dimension == 0 &&
                      std::is_class_v<std::ranges::range_value_t<R>> &&
                      !std::same_as<std::ranges::range_value_t<R>, PointView>;

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

  /// A range of points converts, so it can be passed wherever a view is taken. A temporary as well,
  /// as to std::string_view: it exists until the call returns, but not as long as a view with a
  /// name. Structs of your own: records().
  template <PointRange R>
  PointView(R&& points CULLHULL_LIFETIME_BOUND) noexcept  // NOLINT: a range converts
      : PointView(row_major(reinterpret_cast<const typename internal::PointOf<R>::Scalar*>(
                                std::ranges::data(points)),
                            std::ranges::size(points), internal::PointOf<R>::dimension)) {}

  template <ObjectRange R>
  PointView(R&&) noexcept {  // NOLINT: to say what to write instead
    static_assert(internal::PointOf<R>::dimension != 0,
                  "the items of this range are not known as points (std::array<T, d>, T[d] and "
                  "Eigen's vectors of fixed size are): for structs of your own pass "
                  "cullhull::PointView::records(points, &Point::x, 3)");
  }

  /// Eigen's matrices, too. Their rows are the points: MatrixXd(3, 100) is 3 points in 100D. If the
  /// type fixes the number of rows alone, columns are: Matrix3Xd, Matrix<double, 3, Dynamic>.
  template <PointMatrix M>
  PointView(const M& points CULLHULL_LIFETIME_BOUND) noexcept  // NOLINT: a matrix converts
      : PointView(of_matrix(points)) {}

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

/// Coordinates by number: std::array, std::span, std::vector, a vector of Eigen's or an expression
/// of such.
template <class P>
concept CoordinateList = requires(const P& p) {
  { p.size() } -> std::convertible_to<std::size_t>;
  p[0];
}
&&std::is_arithmetic_v<std::remove_cvref_t<decltype(std::declval<const P&>()[0])>>;

/// One point or direction, as queries take it: coordinates by number of any scalar type that is
/// read, T[d], a list in braces, or a pointer to as many doubles as the query has dimensions. A
/// parameter's type: it refers to what it is made of, if that is doubles in a row.
class OnePoint {
 public:
  OnePoint(const double* p CULLHULL_LIFETIME_BOUND) noexcept  // NOLINT: points convert
      : data_(p) {}
  OnePoint(std::initializer_list<double> p CULLHULL_LIFETIME_BOUND) noexcept  // NOLINT: as above
      : size_(p.size()), known_(true) {
    take(p.begin(), p);
  }
  template <class T, std::size_t D>
  OnePoint(const T (&p CULLHULL_LIFETIME_BOUND)[D]) : size_(D), known_(true) {  // NOLINT: as above
    take(std::data(p), p);
  }
  template <CoordinateList P>
  OnePoint(const P& p CULLHULL_LIFETIME_BOUND)  // NOLINT: as above
      : size_(static_cast<std::size_t>(p.size())), known_(true) {
    if constexpr (std::ranges::contiguous_range<const P>)
      take(std::ranges::data(p), p);
    else
      take(nullptr, p);
  }
  OnePoint(const OnePoint&) = delete;
  OnePoint& operator=(const OnePoint&) = delete;

  /// The coordinates. Throws Error{invalid_argument} if they are not `dimension`, as far as their
  /// number is known.
  const double* of(std::uint32_t dimension) const {
    if (known_ && size_ != dimension)
      throw Error(ErrorCode::invalid_argument, "a point of ", size_, " coordinates, not ",
                  dimension);
    return data_;
  }

 private:
  template <class Data, class P>
  void take([[maybe_unused]] const Data& data, const P& p) {
    using Index = std::conditional_t<std::is_array_v<P>, std::size_t, decltype(std::size(p))>;
    if constexpr (std::is_same_v<Data, const double*>) {
      data_ = data;
    } else {
      using Scalar = std::remove_cvref_t<decltype(p[0])>;
      (void)scalar_type_of<Scalar>();
      if (size_ > few_.size()) many_.resize(size_);
      double* const out = size_ > few_.size() ? many_.data() : few_.data();
      for (std::size_t i = 0; i < size_; ++i)
        out[i] = static_cast<double>(p[static_cast<Index>(i)]);
      data_ = out;
    }
  }

  const double* data_ = nullptr;
  std::size_t size_ = 0;
  bool known_ = false;
  std::array<double, 4> few_{};
  std::vector<double> many_;
};

}  // namespace cullhull
#pragma GCC visibility pop
