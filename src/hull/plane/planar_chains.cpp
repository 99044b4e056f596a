#include "hull/plane/planar_chains.hpp"

#include <algorithm>
#include <bit>
#include <utility>

namespace cullhull::internal {
namespace {

/// Up to this many points are sorted by insertion. 8, 16, 40 and 64 differ from 24 by less than 1 %
/// (a circle of 200,000 points).
constexpr std::uint32_t few = 24;

/// A stable sort, in linear time where few entries are out of order.
void insertion_sort(Entry* begin, Entry* end) {
  for (Entry* i = begin + 1; i < end; ++i) {
    if (!before(*i, i[-1])) continue;
    const Entry e = *i;
    Entry* j = i;
    do {
      *j = j[-1];
      --j;
    } while (j > begin && before(e, j[-1]));
    *j = e;
  }
}

/// Sorts entries of equal x: the last becomes the highest, all others copies of the lowest.
void sort_column(Entry* begin, Entry* end) {
  const auto [low, high] = std::minmax_element(begin, end, before);
  const Entry lowest = *low;
  Entry highest = *high;
  for (const Entry* i = begin; i < end; ++i)  // of equal points takes the lowest row
    if (equal(*i, highest) && i->row < highest.row) highest = *i;
  std::fill(begin, end - 1, lowest);
  end[-1] = highest;
}

/// Sorts by keys over the entries' own range of x, and recurses into crowded cells. `depth`: the
/// number of further levels; inputs that crowd at every level are left to comparisons.
void sort_many(Entry* begin, Entry* end, unsigned depth, const Control& control) {
  const auto n = static_cast<std::uint32_t>(end - begin);
  control.check();
  const auto [low, high] =
      std::minmax_element(begin, end, [](const Entry& a, const Entry& b) { return a.x < b.x; });
  if (low->x == high->x) return sort_column(begin, end);
  const KeyMap map(low->x, high->x);
  if (depth == 0 || !map.useful()) {
    std::uint32_t calls = 0;
    std::sort(begin, end, [&](const Entry& a, const Entry& b) {
      if (++calls % (1U << 16) == 0) control.check();
      return before(a, b);
    });
    return;
  }
  const auto bits = std::min(18U, static_cast<unsigned>(std::bit_width(n)));
  const unsigned shift = 32 - bits;
  std::vector<std::uint32_t> next((std::size_t{1} << bits) + 1, 0);
  for (Entry* i = begin; i < end; ++i) {
    i->key = map.key(i->x);
    ++next[(i->key >> shift) + 1];
  }
  for (std::size_t c = 1; c < next.size(); ++c) next[c] += next[c - 1];
  const Array<Entry> old(begin, end);
  for (const Entry& e : old) begin[next[e.key >> shift]++] = e;
  // next[c] is now the end of cell c; the lowest and the highest x are in different ones.
  for (std::size_t c = 0, from = 0; c + 1 < next.size(); from = next[c++]) {
    if (next[c] - from <= few)
      insertion_sort(begin + from, begin + next[c]);
    else
      sort_many(begin + from, begin + next[c], depth - 1, control);
  }
}

}  // namespace

// Halving keeps the range of the largest doubles finite; on subnormal numbers it may round, which
// leaves the map monotone.
KeyMap::KeyMap(double low, double high) {
  if (std::fabs(low) > 0x1p1000 || std::fabs(high) > 0x1p1000) half_ = 0.5;
  low_ = low * half_;
  const double range = high * half_ - low_;
  if (range > 0x1p-900) scale_ = top / range;
}

void sort_entries(Entry* begin, Entry* end, const Control& control) {
  if (end - begin <= few)
    insertion_sort(begin, end);
  else if (end - begin <= 256)
    std::sort(begin, end, before);
  else
    sort_many(begin, end, 3, control);
}

/// Distributes the points by the next bits of their keys to about two cells a point, first those
/// below the chord, then those above. A point too near the chord to decide is put on both sides,
/// which is always correct.
void ChainBuilder::divide(const Entry* points, std::uint32_t count, unsigned low_bits) {
  const unsigned cell_bits =
      std::min({low_bits, 16U, static_cast<unsigned>(std::bit_width(count))});
  const std::uint32_t side = std::uint32_t{1} << cell_bits;
  const unsigned shift = low_bits - cell_bits;
  cells_.resize(std::max<std::size_t>(cells_.size(), count));
  next_.assign(2 * std::size_t{side}, 0);
  both_.clear();
  const Entry a = chord_.first, b = chord_.last;
  above_ = 0;
  for (std::uint32_t i = 0; i < count; ++i) {
    const Entry& p = points[i];
    const double l = (a.x - p.x) * (b.y - p.y);
    const double r = (a.y - p.y) * (b.x - p.x);
    const double error = turn_bound * (std::fabs(l) + std::fabs(r)) + turn_tiny;
    const std::uint32_t cell = (p.key >> shift) & (side - 1);
    const std::uint32_t above = l - r > error;
    if (!(std::fabs(l - r) > error)) {
      both_.push_back(p);
      both_.back().key = cell + side;
      ++next_[cell + side];
    }
    above_ += above;
    const std::uint32_t place = cell + (above << cell_bits);
    cells_[i] = place;
    ++next_[place];
  }
  below_ = count - above_;
  above_ += static_cast<std::uint32_t>(both_.size());
  sorted_.resize(std::max<std::size_t>(sorted_.size(), std::size_t{below_} + above_));
  std::uint32_t sum = 0, fullest = 0;
  for (std::uint32_t& c : next_) {
    fullest = std::max(fullest, c);
    sum += std::exchange(c, sum);
  }
  for (std::uint32_t i = 0; i < count; ++i) sorted_[next_[cells_[i]]++] = points[i];
  for (const Entry& p : both_) sorted_[next_[p.key]++] = p;
  Entry* out = sorted_.data();
  if (fullest > few)
    for (std::size_t c = 0, from = 0; c < next_.size(); from = next_[c++])
      if (next_[c] - from > few) sort_entries(out + from, out + next_[c], *control_);
  insertion_sort(out, out + below_);
  insertion_sort(out + below_, out + below_ + above_);
}

void ChainBuilder::add(const Entry* points, std::uint32_t count, unsigned low_bits) {
  if (count == 0) return;
  divide(points, count, low_bits);
  extend(lower_, lower_count_, sorted_.data(), below_, 1);
  extend(upper_, upper_count_, sorted_.data() + below_, above_, -1);
}

/// A chain turns to the same `side` at every vertex: +1 left, -1 right.
void ChainBuilder::extend(Entries& chain, std::uint32_t& size, const Entry* points,
                          std::uint32_t count, int side) {
  if (chain.size() < std::size_t{size} + count)
    chain.resize(std::max<std::size_t>(std::size_t{size} + count, 2 * chain.size()));
  Entry* const c = chain.data();
  std::uint32_t m = size;
  for (std::uint32_t i = 0; i < count; ++i) {
    const Entry& p = points[i];
    if (m > 0 && equal(c[m - 1], p)) continue;
    while (m >= 2 && turn_(c[m - 2], c[m - 1], p) != side) --m;
    c[m++] = p;
  }
  size = m;
}

}  // namespace cullhull::internal
