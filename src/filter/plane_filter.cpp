#include "filter/plane_filter.hpp"

#include <algorithm>
#include <limits>

#include "filter/lattice/whole_range.hpp"
#include "geometry/gather.hpp"

namespace cullhull::internal {

/// Keeps of the points with the same value on an axis only the lowest and the highest along the
/// other axis, and of equal points the first: no other point can be a corner.
bool PlaneFilter::keep_ends_of_columns(const PointView& set) {
  constexpr std::uint64_t points_per_column = 6, most_columns = 512;
  constexpr std::uint64_t first = 16;  // points that show that most sets have no such axis
  for (const std::uint64_t n : {first, set.count}) {
    const WholeRange range = whole_range(set, n);
    if (!range.finite) return false;
    const auto most = static_cast<double>(std::min(set.count / points_per_column, most_columns));
    const auto columns = [&](unsigned a) {
      return range.whole[a] ? range.high[a] - range.low[a] + 1 : most + 1;
    };
    const unsigned axis = columns(1) < columns(0) ? 1 : 0;
    if (columns(axis) > most) return false;
    if (n == set.count)
      find_ends(set, axis, range.low[axis], static_cast<std::uint32_t>(columns(axis)));
  }
  return true;
}

void PlaneFilter::find_ends(const PointView& set, unsigned axis, double low,
                            std::uint32_t columns) {
  constexpr double none = std::numeric_limits<double>::infinity();
  columns_.assign(columns, {none, -none, 0, 0});
  for_row_blocks(set, set.count, [&](std::uint64_t begin, const double* row, std::uint32_t count) {
    const auto first = static_cast<std::uint32_t>(begin);
    for (std::uint32_t i = first; i < first + count; ++i, row += 2) {
      Column& c = columns_[static_cast<std::uint32_t>(static_cast<std::int32_t>(row[axis] - low))];
      const double at = row[1 - axis];
      if (at < c.least) {
        c.least = at;
        c.first = i;
      }
      if (at > c.most) {
        c.most = at;
        c.last = i;
      }
    }
  });
  kept_.resize(std::max(kept_.size(), std::size_t{2} * columns));
  std::uint32_t k = 0;
  for (const Column& c : columns_) {
    if (c.least > c.most) continue;
    kept_[k++] = c.first;
    if (c.first != c.last) kept_[k++] = c.last;
  }
  std::sort(kept_.begin(), kept_.begin() + k);
  rows_.resize(std::max(rows_.size(), std::size_t{2} * k));
  const double* const packed = packed_doubles(set);
  for (std::uint32_t i = 0; i < k; ++i) {
    double* const to = rows_.data() + 2 * std::size_t{i};
    if (packed != nullptr)
      std::copy_n(packed + 2 * std::size_t{kept_[i]}, 2, to);
    else
      load_rows_as_given(set, kept_[i], std::uint64_t{kept_[i]} + 1, to);
  }
  count_ = k;
}

namespace {

constexpr std::uint32_t block = 2048;

/// Every `step`th point.
PointView sample_of(const PointView& set, std::uint64_t step) {
  PointView sample = set;
  sample.count = (set.count + step - 1) / step;
  sample.point_stride *= static_cast<std::ptrdiff_t>(step);
  return sample;
}

/// Loads `count` points of a sample of every `step`th point, from its number `first` on.
void load_sample(const PointView& set, std::uint64_t step, std::uint64_t first, std::uint64_t count,
                 double* to) {
  const double* from = packed_doubles(set);
  if (from == nullptr) return load_rows_as_given(sample_of(set, step), first, first + count, to);
  from += 2 * first * step;
  for (std::uint64_t i = 0; i < count; ++i, from += 2 * step) {
    to[2 * i] = from[0];
    to[2 * i + 1] = from[1];
  }
}

}  // namespace

void PlaneFilter::make_room() {
  constexpr std::size_t room = most_kept + block;
  if (kept_.size() < room) kept_.resize(room);
  if (rows_.size() < 2 * room) rows_.resize(2 * room);
}

/// Keeps every `step`th point, at most `block` of them.
void PlaneFilter::keep_all(const PointView& set, std::uint64_t step) {
  make_room();
  count_ = static_cast<std::uint32_t>(sample_of(set, step).count);
  load_sample(set, step, 0, count_, rows_.data());
  for (std::uint32_t i = 0; i < count_; ++i) kept_[i] = static_cast<std::uint32_t>(i * step);
}

/// Keeps every `step`th point that the ellipse does not contain; stops after the block of points in
/// which their number exceeds `most_kept`.
void PlaneFilter::keep_outside(const PointView& set, std::uint64_t step,
                               const InnerEllipse& ellipse) {
  make_room();
  const std::uint64_t points = sample_of(set, step).count;
  const double* const packed = step == 1 ? packed_doubles(set) : nullptr;
  double loaded[2 * block];
  std::uint32_t k = 0;
  for (std::uint64_t begin = 0; begin < points && k <= most_kept; begin += block) {
    const std::uint64_t end = std::min(points, begin + block);
    if (packed == nullptr) load_sample(set, step, begin, end - begin, loaded);
    const double* const from = packed != nullptr ? packed + 2 * begin : loaded;
    std::uint32_t* const kept = kept_.data() + k;
    const std::uint32_t n = ellipse.outside(from, static_cast<std::uint32_t>(end - begin), kept);
    double* const to = rows_.data() + 2 * std::size_t{k};
    for (std::uint32_t i = 0; i < n; ++i) {
      const std::size_t row = kept[i];
      to[2 * std::size_t{i}] = from[2 * row];
      to[2 * std::size_t{i} + 1] = from[2 * row + 1];
      kept[i] = static_cast<std::uint32_t>((begin + row) * step);
    }
    k += n;
  }
  count_ = k;
}

/// Whether the last pass may leave few enough points, by how many of a sample are outside of the
/// ellipse in its own hull, and how many were of the sample `before`: from one to the next their
/// number doubles in a disc, but grows six times in a square, whose corners no ellipse reaches.
bool PlaneFilter::may_leave_few(const InnerEllipse& ellipse, std::uint64_t step,
                                std::uint64_t ratio, double& before) {
  constexpr double enough_to_tell = 128;
  outside_.resize(std::max<std::size_t>(outside_.size(), count_));
  double left = ellipse.outside(rows(), count_, outside_.data());
  const double growth = left / before;
  const bool tells = left >= enough_to_tell && before > 0;
  before = left;
  for (left *= static_cast<double>(ratio); step > ratio; step /= ratio) left *= growth;
  return !tells || left <= 2 * most_kept;
}

}  // namespace cullhull::internal
