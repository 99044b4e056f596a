#include "hull/insertion_order.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

namespace cullhull::internal {
namespace {

/// Each round is this many times larger than all before it (8 to 32 measured alike).
constexpr unsigned round_ratio = 16;
constexpr std::uint32_t first_round = 64;

std::uint64_t mix(std::uint64_t x) {  // splitmix64's finaliser: a fixed pseudo-random hash
  x += 0x9E3779B97F4A7C15ULL;
  x = (x ^ (x >> 30)) * 0xBF58476D1CE4E5B9ULL;
  x = (x ^ (x >> 27)) * 0x94D049BB133111EBULL;
  return x ^ (x >> 31);
}

/// Position along a 2D Hilbert curve of 2^bits x 2^bits cells. Without branches: they would be
/// taken at random.
std::uint32_t hilbert_2d(std::uint32_t x, std::uint32_t y, unsigned bits) {
  std::uint32_t key = 0;
  for (unsigned b = bits; b-- > 0;) {
    const std::uint32_t rx = (x >> b) & 1U, ry = (y >> b) & 1U;
    key = (key << 2) | ((3 * rx) ^ ry);
    const std::uint32_t turn = ry - 1;  // all ones where ry == 0
    const std::uint32_t flip = turn & (0 - rx);
    x ^= flip;
    y ^= flip;
    const std::uint32_t swap = (x ^ y) & turn;
    x ^= swap;
    y ^= swap;
  }
  return key;
}

/// Direction of y on the cube map: face, then a Hilbert curve on it; the six curves are laid so
/// that the faces follow one another along shared edges.
std::uint32_t direction_key(const double* y) {
  constexpr unsigned bits = 12;
  constexpr double cells = 1U << bits;
  const double ax = std::abs(y[0]), ay = std::abs(y[1]), az = std::abs(y[2]);
  unsigned axis = 0;
  double m = ax;
  if (ay > m) {
    axis = 1;
    m = ay;
  }
  if (az > m) {
    axis = 2;
    m = az;
  }
  if (!(m > 0x1p-900)) return 0;  // the scale below must be finite
  const double scale = 0.5 * cells / m;
  const unsigned ua = axis == 0 ? 1 : 0, va = axis == 2 ? 1 : 2;
  const auto cell = [&](double c) {
    const double t = c * scale + 0.5 * cells;
    return static_cast<std::uint32_t>(std::min(t, cells - 1));
  };
  const unsigned face = axis + (y[axis] < 0 ? 3 : 0);
  return (face << (2 * bits)) | hilbert_2d(cell(y[ua]), cell(y[va]), bits);
}

/// Position in a d-dimensional Hilbert curve (Skilling 2004), `bits` bits an axis, d * bits <= 32.
std::uint32_t position_key(const double* x, unsigned d, unsigned bits) {
  std::uint32_t c[32] = {};
  const unsigned used = std::min(d, 32U);
  const double cells = static_cast<double>(1U << bits);
  for (unsigned j = 0; j < used; ++j) {
    const double t = (x[j] * 0.5 + 0.5) * cells;
    c[j] = static_cast<std::uint32_t>(std::clamp(t, 0.0, cells - 1));
  }
  for (std::uint32_t q = 1U << (bits - 1); q > 1; q >>= 1) {
    const std::uint32_t p = q - 1;
    for (unsigned j = 0; j < used; ++j) {
      if ((c[j] & q) != 0) {
        c[0] ^= p;
      } else {
        const std::uint32_t t = (c[0] ^ c[j]) & p;
        c[0] ^= t;
        c[j] ^= t;
      }
    }
  }
  for (unsigned j = 1; j < used; ++j) c[j] ^= c[j - 1];
  std::uint32_t t = 0;
  for (std::uint32_t q = 1U << (bits - 1); q > 1; q >>= 1)
    if ((c[used - 1] & q) != 0) t ^= q - 1;
  for (unsigned j = 0; j < used; ++j) c[j] ^= t;
  std::uint32_t key = 0;
  for (unsigned b = bits; b-- > 0;)
    for (unsigned j = 0; j < used; ++j) key = (key << 1) | ((c[j] >> b) & 1U);
  return key;
}

struct Keyed {
  std::uint32_t key, id;
};

/// Least significant digit first; stable, so ties keep id order.
void radix_sort(std::vector<Keyed>& a, std::vector<Keyed>& scratch) {
  constexpr unsigned digit_bits = 11, buckets = 1U << digit_bits;
  std::array<std::array<std::uint32_t, buckets>, 3> counts{};
  for (const Keyed& k : a)
    for (unsigned pass = 0; pass < 3; ++pass)
      ++counts[pass][(k.key >> (pass * digit_bits)) & (buckets - 1)];
  scratch.resize(a.size());
  for (unsigned pass = 0; pass < 3; ++pass) {
    std::uint32_t sum = 0;
    bool one_bucket = false;
    for (std::uint32_t& c : counts[pass]) {
      one_bucket = one_bucket || c == a.size();
      const std::uint32_t n = c;
      c = sum;
      sum += n;
    }
    if (one_bucket) continue;
    for (const Keyed& k : a)
      scratch[counts[pass][(k.key >> (pass * digit_bits)) & (buckets - 1)]++] = k;
    a.swap(scratch);
  }
}

}  // namespace

std::vector<std::uint32_t> insertion_order(const LocalPoints& points, const double* centre) {
  const std::uint32_t n = points.count;
  const unsigned d = points.dimension;
  unsigned rounds = 1;
  for (std::uint64_t size = first_round; size < n; size *= round_ratio) ++rounds;
  // Round r > 0 has a share (1 - 1/ratio) ratio^(r - rounds + 1) of the points.
  std::vector<std::vector<Keyed>> round(rounds);
  round.back().reserve(n);
  const unsigned bits = d > 3 ? std::clamp(32U / d, 1U, 10U) : 0;
  for (std::uint32_t i = 0; i < n; ++i) {
    unsigned r = rounds - 1;
    for (std::uint64_t h = mix(i); r > 0 && h % round_ratio == 0; h /= round_ratio) --r;
    const double* x = points.row(i);
    std::uint32_t key = 0;
    if (r > 0) {
      if (d == 3) {
        const double y[3] = {x[0] - centre[0], x[1] - centre[1], x[2] - centre[2]};
        key = direction_key(y);
      } else {
        key = position_key(x, d, bits);
      }
    }
    round[r].push_back({key, i});
  }
  std::vector<std::uint32_t> order;
  order.reserve(n);
  std::vector<Keyed> scratch;
  for (unsigned r = 0; r < rounds; ++r) {
    if (r > 0) radix_sort(round[r], scratch);
    for (const Keyed& k : round[r]) order.push_back(k.id);
    std::vector<Keyed>().swap(round[r]);
  }
  return order;
}

}  // namespace cullhull::internal
