#include "stream/numbered_points.hpp"

#include <algorithm>
#include <bit>
#include <cstring>
#include <numeric>
#include <span>

#include "cullhull/error.hpp"
#include "parallel/prefetch.hpp"
#include "parallel/radix_sort.hpp"
#include "parallel/threads/run.hpp"

namespace cullhull::internal {

namespace {

/// Copies the points index(i), i < count, as packed rows of `Row` bytes (0: size known at run
/// time). The points are sparse in memory, so each copy would wait for a cache line without the
/// prefetch.
template <std::size_t Row, class Index>
void copy_packed(const PointView& from, const Index& index, std::size_t count, std::byte* out) {
  constexpr std::size_t ahead = 16;
  const std::size_t row = Row > 0 ? Row : from.dimension * scalar_size(from.scalar);
  for (std::size_t i = 0; i < count; ++i, out += row) {
    if (i + ahead < count) prefetch_line(from.address(index(i + ahead), 0));
    std::memcpy(out, from.address(index(i), 0), Row > 0 ? Row : row);
  }
}

template <class Index>
void copy_rows_of(const PointView& from, const Index& index, std::size_t count, std::byte* out) {
  const std::size_t size = scalar_size(from.scalar);
  if (from.coordinate_stride == static_cast<std::ptrdiff_t>(size)) {
    switch (from.dimension * size) {
      case 8:
        return copy_packed<8>(from, index, count, out);
      case 12:
        return copy_packed<12>(from, index, count, out);
      case 16:
        return copy_packed<16>(from, index, count, out);
      case 24:
        return copy_packed<24>(from, index, count, out);
      default:
        return copy_packed<0>(from, index, count, out);
    }
  }
  for (std::size_t i = 0; i < count; ++i) {
    const std::byte* p = from.address(index(i), 0);
    for (std::uint32_t j = 0; j < from.dimension; ++j, out += size, p += from.coordinate_stride)
      std::memcpy(out, p, size);
  }
}

}  // namespace

void copy_rows(const PointView& from, std::uint64_t first, const std::uint32_t* positions,
               std::size_t count, std::byte* out) {
  if (positions != nullptr) {
    copy_rows_of(
        from, [=](std::size_t i) { return first + positions[i]; }, count, out);
  } else if (from.packed_rows()) {
    if (count > 0)
      std::memcpy(out, from.address(first, 0), count * from.dimension * scalar_size(from.scalar));
  } else {
    copy_rows_of(
        from, [=](std::size_t i) { return first + i; }, count, out);
  }
}

PointView NumberedPoints::view() const {
  const auto size = static_cast<std::ptrdiff_t>(scalar_size(scalar));
  return {rows.data(), scalar, dimension, ids.size(), size * dimension, size};
}

void NumberedPoints::grow(std::size_t more) {
  const std::size_t before = ids.size();
  rows.resize((before + more) * row_bytes());
  try {
    ids.resize(before + more);
  } catch (...) {
    rows.resize(before * row_bytes());
    throw;
  }
}

void NumberedPoints::append(const PointView& from, std::uint64_t first,
                            const std::uint32_t* positions, std::size_t count,
                            std::uint64_t first_id) {
  const std::size_t before = ids.size();
  grow(count);
  copy_rows(from, first, positions, count, rows.data() + before * row_bytes());
  for (std::size_t i = 0; i < count; ++i)
    ids[before + i] = first_id + first + (positions != nullptr ? positions[i] : i);
}

void NumberedPoints::append(const PointView& from, const std::vector<std::uint64_t>& positions,
                            std::uint64_t first_id) {
  const std::size_t before = ids.size();
  grow(positions.size());
  copy_rows_of(
      from, [&](std::size_t i) { return positions[i]; }, positions.size(),
      rows.data() + before * row_bytes());
  for (std::size_t i = 0; i < positions.size(); ++i) ids[before + i] = first_id + positions[i];
}

void NumberedPoints::append(const NumberedPoints& other) {
  const std::size_t before = ids.size();
  grow(other.size());
  std::copy(other.ids.begin(), other.ids.end(), ids.begin() + static_cast<std::ptrdiff_t>(before));
  std::copy(other.rows.begin(), other.rows.end(),
            rows.begin() + static_cast<std::ptrdiff_t>(before * row_bytes()));
}

void NumberedPoints::take(std::vector<NumberedPoints>& parts, const Run& run) {
  std::vector<std::size_t> places{size()};
  for (const NumberedPoints& part : parts) places.push_back(places.back() + part.size());
  NumberedPoints all{dimension, scalar, {}, {}};
  all.grow(places.back());
  run.each_item(places.size(), [&](std::uint64_t p) {
    const NumberedPoints& part = p == 0 ? *this : parts[p - 1];
    const std::size_t at = p == 0 ? 0 : places[p - 1];
    std::copy(part.ids.begin(), part.ids.end(), all.ids.data() + at);
    std::copy(part.rows.begin(), part.rows.end(), all.rows.data() + at * row_bytes());
  });
  *this = std::move(all);
  parts.clear();
}

void NumberedPoints::widen() {
  if (scalar == ScalarType::f64) return;
  const PointView narrow = view();
  Array<std::byte> wide(ids.size() * dimension * sizeof(double));
  std::byte* out = wide.data();
  for (std::uint64_t i = 0; i < narrow.count; ++i)
    for (std::uint32_t j = 0; j < dimension; ++j, out += sizeof(double)) {
      const double v = narrow.at(i, j);
      std::memcpy(out, &v, sizeof v);
    }
  rows = std::move(wide);
  scalar = ScalarType::f64;
}

void NumberedPoints::sort(const Run& run) {
  const auto descends = [](std::uint64_t a, std::uint64_t b) { return a >= b; };
  if (std::adjacent_find(ids.begin(), ids.end(), descends) == ids.end()) return;
  if (size() > ~std::uint32_t{0})
    throw Error(ErrorCode::out_of_budget, "more than 2^32 points may be extreme");
  const auto [least, greatest] = std::minmax_element(ids.begin(), ids.end());
  const std::uint64_t low = *least;
  const auto bits = static_cast<unsigned>(std::bit_width(*greatest - low));
  std::vector<std::uint32_t> order(size()), scratch(size());
  std::iota(order.begin(), order.end(), 0U);
  std::uint32_t *sorted = order.data(), *other = scratch.data();
  radix_sort(sorted, other, static_cast<std::uint32_t>(size()), bits, run,
             [&](std::uint32_t i) { return ids[i] - low; });
  const auto same = [&](std::uint32_t a, std::uint32_t b) {
    if (ids[a] != ids[b]) return false;
    if (std::memcmp(rows.data() + a * row_bytes(), rows.data() + b * row_bytes(), row_bytes()) == 0)
      return true;
    throw Error(ErrorCode::invalid_argument, "two different points have the id ", ids[a],
                ": parts that are merged need ids of their own");
  };
  keep(std::span<const std::uint32_t>(sorted, std::unique(sorted, sorted + size(), same)), run);
}

template <class Places>
void NumberedPoints::keep(const Places& places, const Run& run) {
  constexpr std::uint64_t grain = std::uint64_t{1} << 12;  // tens of us of work
  NumberedPoints kept{dimension, scalar, {}, {}};
  kept.grow(places.size());
  const PointView from = view();
  run.each(places.size(), grain, [&](std::uint64_t begin, std::uint64_t end) {
    for (std::uint64_t i = begin; i < end; ++i) kept.ids[i] = ids[places[i]];
    copy_rows_of(
        from, [&](std::size_t i) { return places[begin + i]; }, end - begin,
        kept.rows.data() + begin * row_bytes());
  });
  *this = std::move(kept);
}
template void NumberedPoints::keep(const Array<std::uint64_t>&, const Run&);
template void NumberedPoints::keep(const std::vector<std::uint64_t>&, const Run&);

}  // namespace cullhull::internal
