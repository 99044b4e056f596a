#include "skipped.hpp"

#include <algorithm>
#include <charconv>
#include <cstring>
#include <utility>

#include "arguments.hpp"
#include "cullhull/hull.hpp"
#include "io/skip_nan.hpp"

namespace app {

using cullhull::PointView;

namespace {

/// Point of(i) for each i below `count`, packed.
template <class Of>
PointView packed(const PointView& points, std::uint64_t count, std::vector<std::byte>& memory,
                 const Of& of) {
  const std::size_t size = cullhull::scalar_size(points.scalar);
  const std::uint32_t d = points.dimension;
  std::vector<std::byte> rows(count * d * size);
  std::byte* out = rows.data();
  for (std::uint64_t i = 0; i < count; ++i)
    for (std::uint32_t j = 0; j < d; ++j, out += size)
      std::memcpy(out, points.address(of(i), j), size);
  memory = std::move(rows);
  const auto step = static_cast<std::ptrdiff_t>(size);
  return {memory.data(), points.scalar, d, count, step * d, step};
}

}  // namespace

Skipped::Skipped(const PointView& points) : rows_(cullhull::internal::rows_with_nan(points)) {
  if (any()) kept_ = cullhull::internal::other_rows(points.count, rows_);
}

bool Skipped::contains(std::uint64_t id) const {
  return std::binary_search(rows_.begin(), rows_.end(), id);
}

PointView Skipped::others(const PointView& points, std::vector<std::byte>& memory) const {
  return packed(points, kept_.size(), memory, [&](std::uint64_t i) { return kept_[i]; });
}

void Skipped::restore(cullhull::Hull& hull) const {
  if (!any()) return;
  hull.rename([&](std::uint64_t number) { return kept_[number]; });
  if (!kept_.empty()) hull.point_count += rows_.size();
}

void Skipped::restore(std::vector<std::uint64_t>& ids) const {
  for (std::uint64_t& id : ids) id = id_of(id);
}

void Skipped::restore(cullhull::Survivors& survivors) const {
  if (!any()) return;
  restore(survivors.ids);
  if (!survivors.all) return;
  survivors.all = false;
  survivors.ids = kept_;
}

std::string Skipped::restored(const std::string& message) const {
  const auto point = point_of(message);
  if (!any() || !point || *point >= kept_.size()) return message;
  const std::string before = "point ", number = std::to_string(*point);
  if (!message.starts_with(before)) return message;
  return before + std::to_string(kept_[*point]) + message.substr(before.size() + number.size());
}

PointView Skipped::with_copies(const PointView& points, std::vector<std::byte>& memory) const {
  return packed(points, points.count, memory, [&](std::uint64_t i) { return original(i); });
}

void Skipped::copy_numbers(std::vector<double>& numbers) const {
  if (numbers.empty()) return;
  for (const std::uint64_t row : rows_) numbers[row] = numbers[kept_[0]];
}

void Skipped::restore_copies(cullhull::Hull& hull) const {
  if (any()) hull.rename([&](std::uint64_t id) { return original(id); });
}

void Skipped::restore_copies(cullhull::Triangulation& t) const {
  if (!any()) return;
  for (std::uint32_t& id : t.cells) id = original(id);
  for (std::uint32_t& id : t.hull_facets) id = original(id);
  std::erase_if(t.duplicates, [&](const cullhull::DuplicatePoint& d) {
    return contains(d.id) || d.id == original(d.representative);
  });
  for (cullhull::DuplicatePoint& d : t.duplicates) d.representative = original(d.representative);
  // A copy that is hidden stands for the point.
  for (std::uint32_t& id : t.hidden) id = original(id);
  t.hidden.insert(t.hidden.end(), rows_.begin(), rows_.end());
  std::sort(t.hidden.begin(), t.hidden.end());
}

}  // namespace app
