// Points without a return: rows in which a coordinate is NaN, and the rows beside them.
#pragma once

#include <cstdint>
#include <vector>

#include "io/source.hpp"

namespace cullhull::internal {

/// Whether a coordinate of this point is NaN.
bool has_nan(const PointView& points, std::uint64_t point);

/// The numbers of the points with a NaN, ascending.
std::vector<std::uint64_t> rows_with_nan(const PointView& points);

/// The numbers of the other points of `count`, ascending.
std::vector<std::uint64_t> other_rows(std::uint64_t count, const std::vector<std::uint64_t>& rows);

/// These points, packed row by row; `storage` becomes their memory.
PointView packed_rows(const PointView& points, const std::vector<std::uint64_t>& rows,
                      Buffer& storage);

/// Calls kept(begin, end) for each longest run of points without a NaN and skipped(begin, end) for
/// each longest run of points with one, in order. Without other points kept() gets an empty run,
/// which has a dimension.
template <class Kept, class Skipped>
void for_runs_without_nan(const PointView& points, const Kept& kept, const Skipped& skipped) {
  const std::vector<std::uint64_t> rows = rows_with_nan(points);
  std::uint64_t at = 0;
  bool any = false;
  for (std::size_t i = 0; i < rows.size();) {
    const std::uint64_t begin = rows[i];
    std::uint64_t end = begin;
    while (i < rows.size() && rows[i] == end) ++i, ++end;
    if (at < begin) kept(at, begin);
    any = any || at < begin;
    skipped(begin, end);
    at = end;
  }
  if (at < points.count || !any) kept(at, points.count);
}

}  // namespace cullhull::internal
