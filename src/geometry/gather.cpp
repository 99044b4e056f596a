#include "geometry/gather.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstring>

#include "cullhull/error.hpp"
#include "cullhull/point_view.hpp"
#include "parallel/dispatch.hpp"
#include "parallel/threads/run.hpp"

namespace cullhull::internal {
namespace {

/// Rows of a chunk: some 50 us where they are neighbours, 20 from all over the memory.
constexpr std::uint64_t chunk_size = 1 << 13, scattered_chunk_size = 1 << 10;

/// How to treat -0 among the coordinates.
enum class Zeros { positive, as_given };

/// Copies the rows of the points id(i), i in [begin, end).
template <Zeros zeros, class T, class Id>
void gather_rows_of(const PointView& view, const Id& id, std::uint64_t begin, std::uint64_t end,
                    double* out) {
  const unsigned d = view.dimension;
  for (std::uint64_t i = begin; i < end; ++i) {
    const std::byte* p = view.address(id(i), 0);
    double* row = out + (i - begin) * d;
    for (unsigned j = 0; j < d; ++j) {
      T v;
      std::memcpy(&v, p + static_cast<std::ptrdiff_t>(j) * view.coordinate_stride, sizeof v);
      row[j] = static_cast<double>(v);
      if constexpr (zeros == Zeros::positive) row[j] += 0.0;  // turns -0 into +0
    }
  }
}

template <Zeros zeros = Zeros::positive, class Id>
void gather_rows_of(const PointView& view, const Id& id, std::uint64_t begin, std::uint64_t end,
                    double* out) {
  with_scalar(view.scalar, [&](auto scalar) {
    gather_rows_of<zeros, decltype(scalar)>(view, id, begin, end, out);
  });
}

void gather_rows(const PointView& view, const std::uint64_t* ids, std::uint64_t begin,
                 std::uint64_t end, double* out) {
  if (ids != nullptr)
    gather_rows_of(
        view, [ids](std::uint64_t i) { return ids[i]; }, begin, end, out);
  else
    gather_rows_of(
        view, [](std::uint64_t i) { return i; }, begin, end, out);
}

/// Returns the index of the first non-finite value of [begin, end), or `end`.
std::uint64_t first_bad(const double* values, std::uint64_t begin, std::uint64_t end) {
  double sum = 0;  // x * 0 is NaN exactly for NaN and infinities
  for (std::uint64_t i = begin; i < end; ++i) sum += values[i] * 0.0;
  if (sum == 0) return end;
  while (std::isfinite(values[begin])) ++begin;
  return begin;
}

[[noreturn]] void refuse(std::uint64_t point, unsigned coordinate, double value) {
  throw Error(ErrorCode::not_finite, "point ", point, ", coordinate ", coordinate, " is ",
              (std::isnan(value) ? "NaN" : "infinite"), "; remove or repair such points first");
}

/// Throws Error{not_finite} for the first of `count` rows with a NaN or an infinity, which is point
/// names[i], or i if `names` is null. rows_of(begin, end, memory): the rows of a chunk of `grain`,
/// perhaps in the memory.
template <class RowsOf>
void require_finite(std::uint64_t count, unsigned d, std::uint64_t grain,
                    const std::uint64_t* names, const Run& run, const RowsOf& rows_of) {
  std::atomic<std::uint64_t> lowest{~std::uint64_t{0}};
  run.each(count, grain, [&](std::uint64_t begin, std::uint64_t end) {
    std::vector<double> memory;
    const std::uint64_t values = (end - begin) * d;
    const std::uint64_t bad = first_bad(rows_of(begin, end, memory), 0, values);
    if (bad == values) return;
    std::uint64_t now = lowest.load();
    while (begin * d + bad < now && !lowest.compare_exchange_weak(now, begin * d + bad)) {
    }
  });
  if (lowest == ~std::uint64_t{0}) return;
  const std::uint64_t i = lowest / d;
  const auto j = static_cast<unsigned>(lowest % d);
  std::vector<double> memory;
  refuse(names != nullptr ? names[i] : i, j, rows_of(i, i + 1, memory)[j]);
}

}  // namespace

void require_dimension(std::uint32_t dimension) {
  if (dimension == 0)
    throw Error(ErrorCode::invalid_argument, "points need at least one dimension");
}

void require_points(std::uint32_t dimension, const void* data, std::uint64_t count) {
  require_dimension(dimension);
  if (data == nullptr && count > 0) throw Error(ErrorCode::invalid_argument, "points.data is null");
}

void require_weights(std::span<const double> weights, std::uint64_t count) {
  if (weights.size() != count)
    throw Error(ErrorCode::invalid_argument, "there are ", count, " points, but ", weights.size(),
                " weights");
}

std::vector<std::uint32_t> flat_columns(const std::vector<std::uint32_t>& axes,
                                        unsigned dimension) {
  std::vector<std::uint32_t> columns(axes);
  for (unsigned j = 0; j < dimension; ++j)
    if (std::find(axes.begin(), axes.end(), j) == axes.end()) columns.push_back(j);
  return columns;
}

void gather_rows_at(const PointView& view, std::uint64_t first, const std::uint32_t* offsets,
                    std::size_t count, double* out) {
  gather_rows_of(
      view, [first, offsets](std::uint64_t i) { return first + offsets[i]; }, 0, count, out);
}

void load_row(const PointView& view, std::uint64_t point, double* out) {
  gather_rows(view, nullptr, point, point + 1, out);
}

void load_rows(const PointView& view, std::uint64_t begin, std::uint64_t end, double* out) {
  gather_rows(view, nullptr, begin, end, out);
}

void load_rows_as_given(const PointView& view, std::uint64_t begin, std::uint64_t end,
                        double* out) {
  gather_rows_of<Zeros::as_given>(
      view, [](std::uint64_t i) { return i; }, begin, end, out);
}

void load_axes_3d(const PointView& view, const std::uint64_t* ids, std::uint64_t first,
                  std::uint32_t count, double* x, double* y, double* z) {
  double* const axes[3] = {x, y, z};
  with_scalar(view.scalar, [&](auto zero) {
    for (std::uint32_t i = 0; i < count; ++i) {
      const std::byte* const from = view.address(ids != nullptr ? ids[i] : first + i, 0);
      for (unsigned c = 0; c < 3; ++c) {
        auto value = zero;
        std::memcpy(&value, from + static_cast<std::ptrdiff_t>(c) * view.coordinate_stride,
                    sizeof value);
        axes[c][i] = static_cast<double>(value);
      }
    }
  });
}

Array<double> gather_points(const PointView& view, const std::uint64_t* ids, std::uint64_t count,
                            const Run& run) {
  const unsigned d = view.dimension;
  Array<double> out(count * d);
  require_finite(count, d, ids != nullptr ? scattered_chunk_size : chunk_size, ids, run,
                 [&](std::uint64_t begin, std::uint64_t end, std::vector<double>&) {
    gather_rows(view, ids, begin, end, out.data() + begin * d);
    return out.data() + begin * d;
  });
  return out;
}

void check_rows_finite(const double* rows, std::uint64_t count, unsigned dimension,
                       const std::uint64_t* names, const Run& run) {
  require_finite(count, dimension, chunk_size, names, run,
                 [&](std::uint64_t begin, std::uint64_t, std::vector<double>&) {
    return rows + begin * dimension;
  });
}

void check_finite(const PointView& view, const std::vector<std::uint64_t>* ids, const Run& run) {
  if (view.scalar != ScalarType::f32 && view.scalar != ScalarType::f64) return;
  constexpr std::uint64_t block = 1 << 12;  // rows, copied to the cache before they are tested
  const std::uint64_t* const which = ids != nullptr ? ids->data() : nullptr;
  require_finite(ids != nullptr ? ids->size() : view.count, view.dimension, block, which, run,
                 [&](std::uint64_t begin, std::uint64_t end, std::vector<double>& rows) {
    rows.resize((end - begin) * view.dimension);
    gather_rows(view, which, begin, end, rows.data());
    return rows.data();
  });
}

}  // namespace cullhull::internal

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
