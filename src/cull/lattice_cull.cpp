#include "cull/lattice_cull.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <numeric>

namespace cullhull::internal {
namespace {

struct Keyed {
  std::uint64_t key;
  std::uint32_t id;
};

/// The rank of each distinct value of one axis: all that "between" needs to know of coordinates.
class Ranks {
 public:
  /// False, early, if there are more than `most` distinct values.
  bool collect(const Array<double>& rows, std::uint32_t count, unsigned d, unsigned axis,
               std::size_t most) {
    slots_.assign(1024, Slot{});
    for (std::uint32_t i = 0; i < count; ++i) {
      const double v = rows[std::size_t{i} * d + axis];
      Slot& s = slots_[find(v)];
      if (s.used) continue;
      if (values_.size() == most) return false;
      s = {v, 0, true};
      values_.push_back(v);
      if (2 * values_.size() > slots_.size()) grow();
    }
    std::sort(values_.begin(), values_.end());
    for (std::size_t r = 0; r < values_.size(); ++r)
      slots_[find(values_[r])].rank = static_cast<std::uint32_t>(r);
    return true;
  }
  unsigned bits() const { return static_cast<unsigned>(std::bit_width(values_.size() - 1)); }
  std::uint32_t of(double v) const { return slots_[find(v)].rank; }

 private:
  struct Slot {
    double value = 0;
    std::uint32_t rank = 0;
    bool used = false;
  };
  std::size_t find(double v) const {
    // 0 and -0 are equal, so they must hash alike.
    std::uint64_t h = std::bit_cast<std::uint64_t>(v + 0.0) * 0x9E3779B97F4A7C15ULL;
    h ^= h >> 32;
    std::size_t at = h & (slots_.size() - 1);
    while (slots_[at].used && slots_[at].value != v) at = (at + 1) & (slots_.size() - 1);
    return at;
  }
  void grow() {
    slots_.assign(2 * slots_.size(), Slot{});
    for (const double v : values_) slots_[find(v)] = {v, 0, true};
  }
  std::vector<Slot> slots_;
  std::vector<double> values_;
};

/// Points share a line along an axis only if they agree on all others, so at most one axis may have
/// as many values as points. Told from a sample.
bool looks_like_a_lattice(const Array<double>& rows, std::uint32_t count, unsigned d) {
  constexpr std::uint32_t sample = 1024;
  const std::uint32_t step = std::max(1U, count / sample);
  unsigned all_distinct = 0;
  std::vector<double> values;
  for (unsigned j = 0; j < d; ++j) {
    values.clear();
    for (std::uint64_t i = 0; i < count; i += step) values.push_back(rows[i * d + j]);
    std::sort(values.begin(), values.end());
    const auto distinct = std::unique(values.begin(), values.end()) - values.begin();
    if (10 * static_cast<std::size_t>(distinct) > 9 * values.size() && ++all_distinct > 1)
      return false;
  }
  return true;
}

/// Keys with axis d - 1 lowest; false if they need more than 64 bits.
bool make_keys(const Array<double>& rows, std::uint32_t count, unsigned d,
               std::vector<unsigned>& bits, std::vector<Keyed>& points) {
  points.resize(count);
  for (std::uint32_t i = 0; i < count; ++i) points[i] = {0, i};
  unsigned total = 0;
  for (unsigned j = 0; j < d; ++j) {
    const unsigned left = 64 - total;
    const std::size_t most = left >= 32 ? std::size_t{1} << 32 : std::size_t{1} << left;
    Ranks ranks;
    if (!ranks.collect(rows, count, d, j, most)) return false;
    bits[j] = ranks.bits();
    total += bits[j];
    for (std::uint32_t i = 0; i < count; ++i)
      points[i].key =
          (bits[j] < 64 ? points[i].key << bits[j] : 0) | ranks.of(rows[std::size_t{i} * d + j]);
  }
  return true;
}

/// Stable sort by key, least significant digit first; passes over constant digits are skipped.
void radix_sort(std::vector<Keyed>& a, std::vector<Keyed>& scratch) {
  constexpr unsigned digit_bits = 11, buckets = 1U << digit_bits, passes = 6;
  std::vector<std::array<std::uint32_t, buckets>> counts(passes);
  for (const Keyed& k : a)
    for (unsigned p = 0; p < passes; ++p) ++counts[p][(k.key >> (p * digit_bits)) & (buckets - 1)];
  scratch.resize(a.size());
  for (unsigned p = 0; p < passes; ++p) {
    auto& count = counts[p];
    if (std::find(count.begin(), count.end(), a.size()) != count.end()) continue;
    std::uint32_t sum = 0;
    for (std::uint32_t& c : count) {
      const std::uint32_t n = c;
      c = sum;
      sum += n;
    }
    for (const Keyed& k : a) scratch[count[(k.key >> (p * digit_bits)) & (buckets - 1)]++] = k;
    a.swap(scratch);
  }
}

}  // namespace

bool lattice_cull(const Array<double>& rows, std::uint32_t count, unsigned d,
                  std::vector<std::uint32_t>& kept) {
  if (count == 0) return false;
  if (!looks_like_a_lattice(rows, count, d)) return false;
  std::vector<unsigned> axis_bits(d);
  std::vector<Keyed> points, scratch;
  if (!make_keys(rows, count, d, axis_bits, points)) return false;
  const unsigned total = std::accumulate(axis_bits.begin(), axis_bits.end(), 0U);
  // The axis to scan along is the lowest in the key; rotating the key brings up the next one.
  for (unsigned j = d; j-- > 0;) {
    const unsigned bits = axis_bits[j];
    if (bits == 0 && !(j == 0 && total == 0)) continue;
    radix_sort(points, scratch);
    const auto line = [bits](const Keyed& k) { return bits == 64 ? 0 : k.key >> bits; };
    std::size_t out = 0;
    for (std::size_t i = 0; i < points.size();) {
      std::size_t end = i + 1;
      while (end < points.size() && line(points[end]) == line(points[i])) ++end;
      // Equal keys keep the order of ids, so the first of the equal ones has the lowest id.
      std::size_t last = end - 1;
      while (last > i && points[last - 1].key == points[last].key) --last;
      const Keyed low = points[i], high = points[last];
      points[out++] = low;
      if (high.key != low.key) points[out++] = high;
      i = end;
    }
    points.resize(out);
    if (bits > 0 && bits < total) {
      const std::uint64_t mask = (std::uint64_t{1} << bits) - 1;
      for (Keyed& k : points) k.key = (k.key >> bits) | ((k.key & mask) << (total - bits));
    }
  }
  kept.resize(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) kept[i] = points[i].id;
  std::sort(kept.begin(), kept.end());
  return true;
}

}  // namespace cullhull::internal
