#include "axis_ranges.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <mutex>
#include <type_traits>

#include "parallel/dispatch.hpp"
#include "parallel/threads/parallel.hpp"

namespace app {
namespace {

using cullhull::PointView;

/// A chunk is read twice where a point of it is not finite, so it should be in the cache then.
constexpr std::uint64_t chunk_points = std::uint64_t{1} << 14;
/// Rows that the loop over packed rows takes at once: a whole number of vectors for every type.
constexpr unsigned rows_at_once = 16;

template <class T>
void widen(T v, AxisRanges::Range& range) {
  const auto x = static_cast<double>(v);
  if (x < range.least) range.least = x;
  if (x > range.greatest) range.greatest = x;
}

/// Any strides, and the only loop that names points that are not finite.
template <class T>
void read_each(const PointView& points, std::uint64_t begin, std::uint64_t end, AxisRanges& out) {
  for (std::uint64_t i = begin; i < end; ++i) {
    bool finite = true;
    for (std::uint32_t j = 0; j < points.dimension; ++j) {
      T v;
      std::memcpy(&v, points.address(i, j), sizeof v);
      if constexpr (std::is_floating_point_v<T>) finite = finite && std::isfinite(v);
      widen(v, out.axes[j]);
    }
    if (!finite && out.not_finite++ == 0) out.first_not_finite = i;
  }
}

/// Packed rows of dimension D: each place of a block of rows has a least and a greatest value of
/// its own, so that the compiler can work on vectors. Returns how many points it read: all but the
/// last few, or none where one is not finite.
template <class T, unsigned D>
std::uint64_t read_blocks(const std::byte* rows, std::uint64_t count, AxisRanges& out) {
  constexpr unsigned width = rows_at_once * D;
  const std::uint64_t blocks = count / rows_at_once;
  if (blocks == 0) return 0;
  T least[width], greatest[width], block[width];
  T rest[width] = {};  // 0 x is 0 but for a NaN and infinities
  std::memcpy(least, rows, sizeof least);
  std::memcpy(greatest, rows, sizeof greatest);
  for (std::uint64_t b = 0; b < blocks; ++b) {
    std::memcpy(block, rows + b * sizeof block, sizeof block);
    for (unsigned i = 0; i < width; ++i) {
      least[i] = block[i] < least[i] ? block[i] : least[i];
      greatest[i] = greatest[i] < block[i] ? block[i] : greatest[i];
      if constexpr (std::is_floating_point_v<T>) rest[i] += 0 * block[i];
    }
  }
  if (!std::all_of(rest, rest + width, [](T r) { return r == 0; })) return 0;
  for (unsigned i = 0; i < width; ++i) {
    widen(least[i], out.axes[i % D]);
    widen(greatest[i], out.axes[i % D]);
  }
  return blocks * rows_at_once;
}

template <class T>
void read(const PointView& points, std::uint64_t begin, std::uint64_t end, AxisRanges& out) {
  if (points.packed_rows())
    begin += cullhull::internal::with_dimension<1, 8, 0>(points.dimension, [&](auto d) {
      constexpr unsigned D = decltype(d)::value;
      if constexpr (D == 0)
        return std::uint64_t{0};
      else
        return read_blocks<T, D>(points.address(begin, 0), end - begin, out);
    });
  read_each<T>(points, begin, end, out);
}

}  // namespace

void AxisRanges::add(const AxisRanges& other) {
  if (axes.size() < other.axes.size()) axes.resize(other.axes.size());
  for (std::size_t j = 0; j < other.axes.size(); ++j) {
    axes[j].least = std::min(axes[j].least, other.axes[j].least);
    axes[j].greatest = std::max(axes[j].greatest, other.axes[j].greatest);
  }
  not_finite += other.not_finite;
  first_not_finite = std::min(first_not_finite, other.first_not_finite);
}

AxisRanges axis_ranges(const PointView& points, unsigned threads, std::uint64_t first_id) {
  AxisRanges all;
  all.axes.resize(points.dimension);
  std::mutex mutex;
  cullhull::internal::for_each_chunk(points.count, chunk_points, threads,
                                     [&](std::uint64_t, std::uint64_t begin, std::uint64_t end) {
    AxisRanges part;
    part.axes.resize(points.dimension);
    cullhull::internal::with_scalar(
        points.scalar, [&](auto scalar) { read<decltype(scalar)>(points, begin, end, part); });
    const std::lock_guard lock(mutex);
    all.add(part);
  });
  if (all.not_finite > 0) all.first_not_finite += first_id;
  for (AxisRanges::Range& axis : all.axes) {  // which zero comes first depends on the threads
    axis.least += 0.0;
    axis.greatest += 0.0;
  }
  return all;
}

}  // namespace app
