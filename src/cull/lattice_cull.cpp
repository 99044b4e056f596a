#include "cull/lattice_cull.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

namespace cullhull::internal {
namespace {

struct Keyed {
  std::uint64_t key;
  std::uint32_t id;
};

struct Axis {
  double low = 0, high = 0;
  int unit = 0;        // exponent of the lattice spacing
  double inverse = 0;  // 1 / spacing
  unsigned bits = 0;   // of (value - low) / spacing
};

int lowest_bit_exponent(double v) {
  int e = 0;
  const double m = std::frexp(v, &e);
  const auto integer = static_cast<std::int64_t>(std::ldexp(m, 53));
  return e - 53 + std::countr_zero(static_cast<std::uint64_t>(integer));
}

/// False if the axes need more than 64 bits together.
bool measure(const std::vector<double>& rows, std::uint32_t count, unsigned d,
             std::vector<Axis>& axes) {
  const auto total_bits = [&] {
    unsigned sum = 0;
    for (Axis& a : axes) {
      if (a.low == a.high) {
        a.bits = 0;
        continue;
      }
      // Both ends are multiples of the spacing; beyond 2^52 spacings the difference may round.
      const double cells = std::ldexp(a.high - a.low, -a.unit);
      if (!(cells < 0x1p52)) return 65U;
      a.bits = static_cast<unsigned>(std::bit_width(static_cast<std::uint64_t>(cells)));
      sum += a.bits;
    }
    return sum;
  };
  for (unsigned j = 0; j < d; ++j) {
    axes[j].low = axes[j].high = rows[j];
    axes[j].unit = 1000;
    axes[j].inverse = 0x1p-1000;
  }
  constexpr std::uint32_t first_look = 64;
  for (std::uint32_t i = 0; i < count; ++i) {
    for (unsigned j = 0; j < d; ++j) {
      const double v = rows[std::size_t{i} * d + j];
      Axis& a = axes[j];
      a.low = std::min(a.low, v);
      a.high = std::max(a.high, v);
      if (v == 0) continue;
      const double t = v * a.inverse;
      if (std::abs(t) < 0x1p62 && static_cast<double>(static_cast<std::int64_t>(t)) == t) continue;
      const int unit = lowest_bit_exponent(v);
      if (unit < -1000 || unit > 1000) return false;  // then scaling by the spacing may round
      a.unit = std::min(a.unit, unit);
      a.inverse = std::ldexp(1.0, -a.unit);
    }
    if (i == first_look && total_bits() > 64) return false;
  }
  return total_bits() <= 64;
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

bool lattice_cull(const std::vector<double>& rows, std::uint32_t count, unsigned d,
                  std::vector<std::uint32_t>& kept) {
  if (count == 0) return false;
  std::vector<Axis> axes(d);
  if (!measure(rows, count, d, axes)) return false;
  std::vector<Keyed> points(count), scratch;
  for (std::uint32_t i = 0; i < count; ++i) {
    std::uint64_t key = 0;
    for (unsigned j = 0; j < d; ++j) {
      const Axis& a = axes[j];
      if (a.bits == 0) continue;
      const double cell = (rows[std::size_t{i} * d + j] - a.low) * a.inverse;
      key = (a.bits == 64 ? 0 : key << a.bits) | static_cast<std::uint64_t>(cell);
    }
    points[i] = {key, i};
  }
  unsigned total = 0;
  for (const Axis& a : axes) total += a.bits;
  // The axis to scan along is the lowest in the key; rotating the key brings up the next one.
  for (unsigned j = d; j-- > 0;) {
    const unsigned bits = axes[j].bits;
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
