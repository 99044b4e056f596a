#include "io/skip_nan.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <utility>

namespace cullhull::internal {
namespace {

bool may_have_nan(const PointView& points) {
  return points.scalar == ScalarType::f64 || points.scalar == ScalarType::f32;
}

template <class T>
bool has_nan_of(const PointView& points, std::uint64_t point) {
  bool found = false;
  for (std::uint32_t j = 0; j < points.dimension; ++j) {
    T x;
    std::memcpy(&x, points.address(point, j), sizeof x);
    found = found || std::isnan(x);
  }
  return found;
}

}  // namespace

bool has_nan(const PointView& points, std::uint64_t point) {
  if (!may_have_nan(points)) return false;
  return points.scalar == ScalarType::f64 ? has_nan_of<double>(points, point)
                                          : has_nan_of<float>(points, point);
}

std::vector<std::uint64_t> rows_with_nan(const PointView& points) {
  std::vector<std::uint64_t> rows;
  if (!may_have_nan(points)) return rows;
  for (std::uint64_t i = 0; i < points.count; ++i)
    if (has_nan(points, i)) rows.push_back(i);
  return rows;
}

std::vector<std::uint64_t> other_rows(std::uint64_t count, const std::vector<std::uint64_t>& rows) {
  std::vector<std::uint64_t> others;
  others.reserve(count - rows.size());
  std::size_t next = 0;
  for (std::uint64_t i = 0; i < count; ++i)
    if (next < rows.size() && rows[next] == i)
      ++next;
    else
      others.push_back(i);
  return others;
}

PointView packed_rows(const PointView& points, const std::vector<std::uint64_t>& rows,
                      Buffer& storage) {
  const std::size_t size = scalar_size(points.scalar);
  const std::uint32_t d = points.dimension;
  Buffer packed(std::max<std::size_t>(1, rows.size() * d * size));
  std::byte* out = packed.data();
  for (const std::uint64_t i : rows)
    for (std::uint32_t j = 0; j < d; ++j, out += size) std::memcpy(out, points.address(i, j), size);
  storage = std::move(packed);
  const auto step = static_cast<std::ptrdiff_t>(size);
  return {storage.data(), points.scalar, d, rows.size(), step * d, step};
}

}  // namespace cullhull::internal
