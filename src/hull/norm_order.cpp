#include "hull/norm_order.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "parallel/parallel.hpp"

namespace cullhull::internal {
namespace {

constexpr std::uint32_t first_round = 64;
constexpr std::uint64_t chunk = 8192;
/// Points that the covariance is taken from.
constexpr std::uint32_t covariance_sample = 4096;

std::uint64_t mix(std::uint64_t x) {  // splitmix64's finaliser: a fixed pseudo-random hash
  x += 0x9E3779B97F4A7C15ULL;
  x = (x ^ (x >> 30)) * 0xBF58476D1CE4E5B9ULL;
  x = (x ^ (x >> 27)) * 0x94D049BB133111EBULL;
  return x ^ (x >> 31);
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
      // Inverts low bits of c[0] where the bit is set, else exchanges those of c[0] and c[j]. No
      // branch: bits are as good as random.
      const std::uint32_t set = 0U - static_cast<std::uint32_t>((c[j] & q) != 0);
      const std::uint32_t t = (c[0] ^ c[j]) & p & ~set;
      c[0] ^= t | (p & set);
      c[j] ^= t;
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

/// Least significant digit first; stable, so ties keep their order.
void radix_sort(Keyed* a, std::size_t n, std::vector<Keyed>& scratch, const Control& control) {
  constexpr std::size_t step = std::size_t{1} << 20;
  constexpr unsigned digit_bits = 11, buckets = 1U << digit_bits;
  if (n < buckets) {
    std::stable_sort(a, a + n, [](const Keyed& x, const Keyed& y) { return x.key < y.key; });
    return;
  }
  scratch.resize(n);
  Keyed* from = a;
  Keyed* to = scratch.data();
  for (unsigned pass = 0; pass < 3; ++pass) {
    std::array<std::uint32_t, buckets> at{};
    const auto digit = [pass](const Keyed& k) {
      return (k.key >> (pass * digit_bits)) & (buckets - 1);
    };
    for (std::size_t i = 0; i < n; ++i) {
      if (i % step == 0) control.check();
      ++at[digit(from[i])];
    }
    std::uint32_t sum = 0;
    for (std::uint32_t& c : at) {
      const std::uint32_t count = c;
      c = sum;
      sum += count;
    }
    for (std::size_t i = 0; i < n; ++i) {
      if (i % step == 0) control.check();
      to[at[digit(from[i])]++] = from[i];
    }
    std::swap(from, to);
  }
  if (from != a) std::copy(from, from + n, a);
}

/// |L^-1 (x - mean)|^2 where L L^T is the covariance. A help only: rounding costs nothing but
/// quality.
class Norm {
 public:
  explicit Norm(const LocalPoints& points) : d_(points.dimension), mean_(d_, 0.0) {
    const std::uint32_t n = points.count, stride = std::max(1U, n / covariance_sample);
    std::uint32_t used = 0;
    for (std::uint64_t i = 0; i < n; i += stride, ++used)
      for (unsigned j = 0; j < d_; ++j) mean_[j] += points.row(static_cast<std::uint32_t>(i))[j];
    for (double& m : mean_) m /= used;
    factor_.assign(std::size_t{d_} * d_, 0.0);
    std::vector<double> y(d_);
    for (std::uint64_t i = 0; i < n; i += stride) {
      const double* x = points.row(static_cast<std::uint32_t>(i));
      for (unsigned j = 0; j < d_; ++j) y[j] = x[j] - mean_[j];
      for (unsigned j = 0; j < d_; ++j)
        for (unsigned k = 0; k <= j; ++k) factor_[j * d_ + k] += y[j] * y[k] / used;
    }
    factorise();
  }

  double of(const double* x, double* y) const {
    double sum = 0;
    for (unsigned j = 0; j < d_; ++j) {
      double v = x[j] - mean_[j];
      for (unsigned k = 0; k < j; ++k) v -= factor_[j * d_ + k] * y[k];
      y[j] = v * factor_[j * d_ + j];
      sum += y[j] * y[j];
    }
    return sum;
  }

 private:
  /// Cholesky; the diagonal holds reciprocals. A direction without extent counts as nothing.
  void factorise() {
    for (unsigned j = 0; j < d_; ++j) {
      const double whole = factor_[j * d_ + j];
      for (unsigned k = 0; k < j; ++k) {
        double v = factor_[j * d_ + k];
        for (unsigned l = 0; l < k; ++l) v -= factor_[j * d_ + l] * factor_[k * d_ + l];
        factor_[j * d_ + k] = v * factor_[k * d_ + k];
      }
      double v = whole;
      for (unsigned k = 0; k < j; ++k) v -= factor_[j * d_ + k] * factor_[j * d_ + k];
      factor_[j * d_ + j] = v > 0x1p-40 * whole && v > 0x1p-900 ? 1 / std::sqrt(v) : 0;
    }
  }

  unsigned d_;
  std::vector<double> mean_, factor_;
};

}  // namespace

InsertionRounds norm_order(const LocalPoints& points, unsigned threads, const Control& control) {
  const std::uint32_t n = points.count;
  const unsigned d = points.dimension;
  const Norm norm(points);
  std::vector<Keyed> keyed(n), scratch;
  for_each_chunk(n, chunk, threads, [&](std::uint64_t, std::uint64_t begin, std::uint64_t end) {
    control.check();
    std::vector<double> y(d);
    for (auto i = static_cast<std::uint32_t>(begin); i < end; ++i) {
      // Floats that are not negative are ordered as their bits; the hash breaks ties.
      const auto v = static_cast<float>(std::min(norm.of(points.row(i), y.data()), 1e30));
      const auto tie = static_cast<std::uint32_t>(mix(i) & 0xFFU);
      keyed[i] = {~((std::bit_cast<std::uint32_t>(v) & ~0xFFU) | tie), i};
    }
  });
  radix_sort(keyed.data(), n, scratch, control);
  InsertionRounds rounds;
  rounds.starts = {0};
  const unsigned bits = std::clamp(32U / d, 1U, 10U);
  for (std::uint32_t begin = 0, end = std::min(n, first_round); begin < n;) {
    if (begin > 0) {
      for_each_chunk(end - begin, chunk, threads,
                     [&](std::uint64_t, std::uint64_t from, std::uint64_t to) {
                       control.check();
                       for (std::uint64_t i = begin + from; i < begin + to; ++i)
                         keyed[i].key = position_key(points.row(keyed[i].id), d, bits);
                     });
      radix_sort(keyed.data() + begin, end - begin, scratch, control);
    }
    rounds.starts.push_back(end);
    begin = end;
    end = n - end < end / 2 ? n : end + end / 2;
  }
  rounds.order.resize(n);
  for (std::uint32_t i = 0; i < n; ++i) rounds.order[i] = keyed[i].id;
  return rounds;
}

}  // namespace cullhull::internal
