#include "few/small_polygon.hpp"

#include <algorithm>
#include <limits>
#include <utility>

#include "few/whole_range.hpp"
#include "geometry/gather.hpp"
#include "result/write/few_lists.hpp"

namespace cullhull::internal {
namespace {

/// With fewer points a sample costs more than it saves: 12 % more time at 130 and 160 points in a
/// disc. At 200 and 250 points it saves 12 to 16 % in discs and 10 to 13 % in Gaussian sets, and
/// costs 7 to 8 % on circles.
constexpr std::uint32_t smallest_worth_thinning = 192;

/// Sets that are searched for columns, points per column, and columns.
constexpr std::uint32_t smallest_worth_columns = 96, rows_per_column = 6, most_columns = 512;

bool finite(const double* values, std::uint32_t count) {
  double sum[4] = {};  // x * 0 is NaN exactly for NaN and infinities
  std::uint32_t i = 0;
  for (; i + 4 <= count; i += 4)
    for (unsigned j = 0; j < 4; ++j) sum[j] += values[i + j] * 0.0;
  for (; i < count; ++i) sum[0] += values[i] * 0.0;
  return sum[0] + sum[1] + sum[2] + sum[3] == 0;
}

}  // namespace

bool SmallPolygon::find(const PointView& set) {
  if (set.dimension != 2 || set.count < 3 || set.count > most_points) return false;
  const auto n = static_cast<std::uint32_t>(set.count);
  rows_ = rows_as_given(set, loaded_);
  kept_count_ = n;
  all_ = !thin_columns(n) && (n < smallest_worth_thinning || !thin(n));
  if (all_ && n > most_kept) return false;
  const double* const rows = all_ ? rows_ : kept_rows_.data();
  if (!finite(rows, 2 * kept_count_)) return false;
  const std::vector<std::uint32_t>& corners = series_.corners(rows, kept_count_);
  if (corners.size() < 3) return false;
  rank(corners);
  return true;
}

/// Where an axis has few whole values, keeps of the rows with the same value only the lowest and
/// the highest along the other axis, and of equal rows the first: no other row can be a corner.
/// Returns false elsewhere, and keeps all rows.
bool SmallPolygon::thin_columns(std::uint32_t count) {
  constexpr std::uint32_t first = 16;  // points that show that most sets have no such axis
  if (count < smallest_worth_columns) return false;
  for (const std::uint32_t n : {first, count}) {
    const WholeRange range = whole_range(rows_, n, 2);
    if (!range.finite) return false;
    const double most = std::min(count / rows_per_column, most_columns);
    const auto columns = [&](unsigned a) {
      return range.whole[a] ? range.high[a] - range.low[a] + 1 : most + 1;
    };
    const unsigned axis = columns(1) < columns(0) ? 1 : 0;
    if (columns(axis) > most) return false;
    if (n == count) keep_ends(axis, range.low[axis], static_cast<std::uint32_t>(columns(axis)));
  }
  return true;
}

void SmallPolygon::keep_ends(unsigned axis, double low, std::uint32_t columns) {
  constexpr double none = std::numeric_limits<double>::infinity();
  columns_.assign(columns, {none, -none, 0, 0});
  const double* row = rows_;
  for (std::uint32_t i = 0; i < kept_count_; ++i, row += 2) {
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
  kept_.resize(std::max(kept_.size(), std::size_t{2} * columns));
  std::uint32_t k = 0;
  for (const Column& c : columns_) {
    if (c.least > c.most) continue;
    kept_[k++] = c.first;
    if (c.first != c.last) kept_[k++] = c.last;
  }
  std::sort(kept_.begin(), kept_.begin() + k);
  take_kept(k);
}

/// Discards inner rows by samples of every 8th, 64th, ... row: the hull of the smallest sample
/// thins the next larger one, and so on, so that all samples but the largest take little time.
/// Returns false and keeps all rows where this does not pay.
bool SmallPolygon::thin(std::uint32_t count) {
  // Each sample takes an eighth of the time of the next; the hull of the first has some twenty
  // corners.
  constexpr std::uint32_t ratio = 8, first_sample = 200;
  std::uint32_t step = ratio;
  while (count / step > first_sample) step *= ratio;
  keep_rows(count, step, InnerDisc());
  for (;;) {
    if (!finite(kept_rows_.data(), 2 * kept_count_)) break;
    const std::vector<std::uint32_t>& corners = series_.corners(kept_rows_.data(), kept_count_);
    // Efron 1965: the share of the points outside a sample's hull is about the share of the sample
    // that is extreme.
    if (corners.size() < 3 || corners.size() > count / step / 3) break;
    const InnerDisc disc(kept_rows_.data(), corners, series_.box());
    step /= ratio;
    keep_rows(count, step, disc);
    if (kept_count_ > most_kept) break;
    if (step == 1) return true;
  }
  kept_count_ = count;
  return false;
}

/// Keeps every `step`th row that the disc does not contain; stops after the block of rows in which
/// their number exceeds `most_kept`.
void SmallPolygon::keep_rows(std::uint32_t count, std::uint32_t step, const InnerDisc& disc) {
  constexpr std::uint32_t block = 2048;
  if (kept_.size() < most_kept + block) kept_.resize(most_kept + block);
  const double* const rows = rows_;
  std::uint32_t* const kept = kept_.data();
  std::uint32_t k = 0;
  for (std::uint32_t begin = 0; begin < count && k <= most_kept; begin += block * step) {
    const std::uint32_t end = std::min(count, begin + block * step), before = k;
    if (step == 1) {
      k += disc.outside(rows + 2 * std::size_t{begin}, end - begin, kept + k);
      // The disc numbers rows from the block's first one.
      for (std::uint32_t i = before; i < k; ++i) kept[i] += begin;
      continue;
    }
    for (std::uint32_t row = begin; row < end; row += step) {
      kept[k] = row;  // overwritten by the next unless counted: no branch
      k += !disc.contains(rows[2 * std::size_t{row}], rows[2 * std::size_t{row} + 1]);
    }
  }
  take_kept(k);
}

/// Gathers the first k rows of kept_.
void SmallPolygon::take_kept(std::uint32_t k) {
  kept_rows_.resize(std::max(kept_rows_.size(), std::size_t{2} * k));
  double* const to = kept_rows_.data();
  for (std::uint32_t i = 0; i < k; ++i) {
    to[2 * std::size_t{i}] = rows_[2 * std::size_t{kept_[i]}];
    to[2 * std::size_t{i} + 1] = rows_[2 * std::size_t{kept_[i]} + 1];
  }
  kept_count_ = k;
}

/// The set's coordinates as packed doubles, unchanged: negative zeros included.
void SmallPolygon::rank(const std::vector<std::uint32_t>& corners) {
  const std::uint32_t rows = kept_count_;
  const std::size_t h = corners.size();
  rank_.assign(rows, 0);
  for (const std::uint32_t row : corners) rank_[row] = 1;
  by_rank_.resize(h);
  std::uint32_t count = 0;
  for (std::uint32_t row = 0; row < rows; ++row) count += std::exchange(rank_[row], count);
  // Counter-clockwise from the lowest row.
  const auto lowest =
      static_cast<std::size_t>(std::min_element(corners.begin(), corners.end()) - corners.begin());
  cycle_.resize(h);
  for (std::size_t i = 0; i < h; ++i) {
    const std::uint32_t row = corners[lowest + i < h ? lowest + i : lowest + i - h];
    cycle_[i] = rank_[row];
    by_rank_[rank_[row]].row = all_ ? row : kept_[row];
  }
  for (std::size_t i = 0; i < h; ++i) {
    by_rank_[cycle_[i]].before = cycle_[i == 0 ? h - 1 : i - 1];
    by_rank_[cycle_[i]].after = cycle_[i + 1 == h ? 0 : i + 1];
  }
}

bool SmallPolygon::measure(const PointView& set, double* planes, PlanarMeasures& measures) {
  const EdgeKernel kernel(series_.box());
  if (!kernel.ordinary()) return false;
  for (Corner& c : by_rank_)
    c.point = kernel.scaled({rows_[2 * std::size_t{c.row}], rows_[2 * std::size_t{c.row} + 1]});
  static_assert(most_kept <= measure_chunk);  // one chunk of sums
  Share<2, DoubleDouble> sums;
  const std::size_t h = by_rank_.size();
  Share<2> run;
  for (std::size_t i = 0; i < h; ++i) {
    Share<2> share;
    const Corner& c = by_rank_[i];
    if (!kernel.edge(c.point, by_rank_[c.before].point, by_rank_[0].point, planes + 3 * i, share))
      return false;
    run.add(share);
    if ((i + 1) % measure_run != 0 && i + 1 != h) continue;
    sums.add(run);
    run = {};
  }
  Share<2, DoubleDouble> all;
  all.add(sums);
  return finish_polygon(kernel, all, set, by_rank_[0].row, measures);
}

void SmallPolygon::write_vertices(std::uint64_t* vertices) const {
  for (std::size_t i = 0; i < cycle_.size(); ++i) vertices[i] = by_rank_[cycle_[i]].row;
}

template <class Target>
bool SmallPolygon::write(const PointView& set, Target& target) {
  const std::size_t h = size(), before = target.facet_planes.size();
  PlanarMeasures measures;
  target.facet_planes.resize(before + 3 * h);
  if (!measure(set, target.facet_planes.data() + before, measures)) {
    target.facet_planes.resize(before);
    return false;
  }
  write_measures(2, set.count, measures.volume, measures.area, measures.centroid, target);
  const auto two = [](std::size_t) { return 2; };
  write_lists(FewSizes{2, h, h, h, 2 * h}, target, two, [&](const FewLists& to) {
    write_vertices(to.vertices);
    for (std::size_t i = 0; i < h; ++i) {
      const Corner& c = by_rank_[i];
      to.simplices[2 * i] = to.facets[2 * i + 1] = c.row;
      to.simplices[2 * i + 1] = to.facets[2 * i] = by_rank_[c.before].row;
      to.simplex_neighbours[2 * i] = to.facet_neighbours[2 * i + 1] = c.before;
      to.simplex_neighbours[2 * i + 1] = to.facet_neighbours[2 * i] = c.after;
    }
  });
  return true;
}
template bool SmallPolygon::write(const PointView&, Hull&);
template bool SmallPolygon::write(const PointView&, HullBatch&);

}  // namespace cullhull::internal
