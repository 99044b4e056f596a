// Copies points of a view into packed doubles, which all later code works on.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "cullhull/array.hpp"
#include "cullhull/error.hpp"
#include "cullhull/point_view.hpp"

namespace cullhull::internal {

struct Run;
/// Throws Error{invalid_argument}; the message consists of these parts.
template <class... Parts>
[[noreturn]] void refuse(const Parts&... parts) {
  throw Error(ErrorCode::invalid_argument, parts...);
}

/// Throws Error{invalid_argument} for points of dimension 0, and for points without data.
void require_points(std::uint32_t dimension, const void* data, std::uint64_t count);
inline void require_points(const PointView& view) {
  require_points(view.dimension, view.data, view.count);
}
/// Checks only the dimension.
void require_dimension(std::uint32_t dimension);

/// Throws Error{invalid_argument} unless there is one weight for each of `count` points.
void require_weights(std::span<const double> weights, std::uint64_t count);

/// Returns the columns of points in a flat: its axes first, then the others, ascending.
std::vector<std::uint32_t> flat_columns(const std::vector<std::uint32_t>& axes, unsigned dimension);

/// Returns row-major doubles of the points `ids` (nullptr: all `count` points of the view). -0
/// becomes +0. Throws Error{not_finite} naming the lowest id with a NaN or an infinity; ids must
/// ascend. The view may be a mapped file that is being read from disk, so this and check_finite can
/// be cancelled.
Array<double> gather_points(const PointView& view, const std::uint64_t* ids, std::uint64_t count,
                            const Run& run);

/// Copies the rows of the points first + offsets[i], i < count, without a check for finiteness; -0
/// becomes +0.
void gather_rows_at(const PointView& view, std::uint64_t first, const std::uint32_t* offsets,
                    std::size_t count, double* out);

/// Copies the exact coordinates of one point, without a check for finiteness. Loops over many
/// points are about as fast as gather_points if the scalar type stays the same.
void load_row(const PointView& view, std::uint64_t point, double* out);

/// Does the same for the points [begin, end), row by row.
void load_rows(const PointView& view, std::uint64_t begin, std::uint64_t end, double* out);
/// Does the same but keeps the sign of each zero, which affects the planes of edges.
void load_rows_as_given(const PointView& view, std::uint64_t begin, std::uint64_t end, double* out);

/// The coordinates of points in space by axis, as given: of `count` points with the given ids, or
/// without ids (nullptr) of those from `first` on.
void load_axes_3d(const PointView& view, const std::uint64_t* ids, std::uint64_t first,
                  std::uint32_t count, double* x, double* y, double* z);

/// Whether none of the values is a NaN or an infinity.
inline bool all_finite(const double* values, std::size_t count) {
  double sum[8] = {};  // x * 0 is NaN exactly for NaN and infinities
  std::size_t i = 0;
  for (; i + 8 <= count; i += 8)
    for (unsigned j = 0; j < 8; ++j) sum[j] += values[i + j] * 0.0;
  for (; i < count; ++i) sum[0] += values[i] * 0.0;
  return sum[0] + sum[1] + sum[2] + sum[3] + sum[4] + sum[5] + sum[6] + sum[7] == 0;
}

/// The rows of a view that lie as packed doubles; nullptr for others.
inline const double* packed_doubles(const PointView& view) {
  const bool aligned = reinterpret_cast<std::uintptr_t>(view.data) % alignof(double) == 0;
  return view.scalar == ScalarType::f64 && view.packed_rows() && aligned
             ? reinterpret_cast<const double*>(view.data)
             : nullptr;
}
/// The rows as packed doubles: in place, or copied to `memory` by load_rows_as_given().
inline const double* rows_as_given(const PointView& view, std::vector<double>& memory) {
  if (const double* const rows = packed_doubles(view)) return rows;
  memory.resize(std::max<std::size_t>(memory.size(), view.count * view.dimension));
  load_rows_as_given(view, 0, view.count, memory.data());
  return memory.data();
}

/// Calls use(first, rows, count) for the first `count` points in their order, block by block, with
/// their rows as rows_as_given() gives them: one block where they lie so, else 2048 points at once.
template <class Use>
void for_row_blocks(const PointView& view, std::uint64_t count, Use&& use) {
  if (const double* const rows = packed_doubles(view))
    return use(std::uint64_t{0}, rows, static_cast<std::uint32_t>(count));
  constexpr std::uint64_t block = 2048;
  std::vector<double> room(block * view.dimension);
  for (std::uint64_t first = 0; first < count; first += block) {
    const std::uint64_t end = std::min(count, first + block);
    load_rows_as_given(view, first, end, room.data());
    use(first, room.data(), static_cast<std::uint32_t>(end - first));
  }
}

/// Throws as gather_points does. `ids`: nullptr means all points. Memory O(threads).
void check_finite(const PointView& view, const std::vector<std::uint64_t>* ids, const Run& run);

/// Checks packed rows that are copies of points: row i is point names[i], or i if `names` is null.
void check_rows_finite(const double* rows, std::uint64_t count, unsigned dimension,
                       const std::uint64_t* names, const Run& run);

}  // namespace cullhull::internal
