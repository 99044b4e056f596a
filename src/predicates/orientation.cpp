#include "predicates/orientation.hpp"

#include <gmp.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <vector>

#include "predicates/double_parts.hpp"
#include "predicates/minors.hpp"

namespace cullhull::internal {
namespace {

__extension__ typedef __int128 Int128;

// ---------------------------------------------------------------------------------------------
// Rung 2: double arithmetic with a bound from the permanent (docs/exactness.md, "Orientation
// filter").

template <unsigned D>
bool filtered(const double* const* p, Sign& sign) {
  double m[D][D];
  double largest = 0;
  for (unsigned i = 0; i < D; ++i)
    for (unsigned j = 0; j < D; ++j) {
      m[i][j] = p[i + 1][j] - p[0][j];
      largest = std::max(largest, std::abs(m[i][j]));
    }
  // Within these magnitudes no product overflows (8! 2^800) and every underflow, however amplified
  // by the factors that follow it, adds up to less than 2^-340.
  if (!(largest >= 0x1p-100 && largest <= 0x1p100)) return false;
  double det[1U << D], perm[1U << D];
  expand_minors<D, true>(m, D, det, perm);
  constexpr double factor = (minor_roundings(D) + 2) * unit_roundoff;
  const double value = det[(1U << D) - 1];
  const double bound = factor * perm[(1U << D) - 1] + 0x1p-340;
  if (value > bound) {
    sign = Sign::positive;
    return true;
  }
  if (value < -bound) {
    sign = Sign::negative;
    return true;
  }
  // All in a plane across an axis, as on a box: a column of zeros (differences of doubles are zero
  // only where they are equal).
  for (unsigned j = 0; j < D; ++j) {
    bool zero = true;
    for (unsigned i = 0; i < D; ++i) zero &= m[i][j] == 0;
    if (!zero) continue;
    sign = Sign::zero;
    return true;
  }
  return false;
}

bool filtered(unsigned d, const double* const* p, Sign& sign) {
  switch (d) {
    case 1:
      sign = sign_of(p[1][0] < p[0][0] ? -1 : p[1][0] > p[0][0] ? 1 : 0);
      return true;  // a comparison is exact
    case 2:
      return filtered<2>(p, sign);
    case 3:
      return filtered<3>(p, sign);
    case 4:
      return filtered<4>(p, sign);
    case 5:
      return filtered<5>(p, sign);
    case 6:
      return filtered<6>(p, sign);
    case 7:
      return filtered<7>(p, sign);
    case 8:
      return filtered<8>(p, sign);
    default:
      return false;
  }
}

// ---------------------------------------------------------------------------------------------
// Rung 3: integers. Column j of the points is multiplied by 2^-e_j, the largest power of two that
// makes all of it integral; signs of determinants do not change under positive column scaling.

int bit_length(std::uint64_t v) { return 64 - std::countl_zero(v); }

/// mpz_t values kept for reuse by one thread.
class Pool {
 public:
  ~Pool() {
    for (auto& block : blocks_)
      for (std::size_t i = 0; i < block_size; ++i) mpz_clear(block[i]);
  }
  /// `count` pointers; values undefined.
  mpz_ptr* take(std::size_t count) {
    while (pointers_.size() < count) {
      blocks_.push_back(std::make_unique<mpz_t[]>(block_size));
      for (std::size_t i = 0; i < block_size; ++i) {
        mpz_init(blocks_.back()[i]);
        pointers_.push_back(blocks_.back()[i]);
      }
    }
    return pointers_.data();
  }

 private:
  static constexpr std::size_t block_size = 64;
  std::vector<std::unique_ptr<mpz_t[]>> blocks_;
  std::vector<mpz_ptr> pointers_;
};

/// Coordinates of points as exact integers, column j in units of 2^exponent(j).
class IntegerPoints {
 public:
  /// Points may be given as two runs: `count` at p, then `more_count` at more.
  IntegerPoints(unsigned d, const double* const* p, unsigned count,
                const double* const* more = nullptr, unsigned more_count = 0)
      : d_(d), scaled_(std::size_t{count + more_count} * d), exponent_(d) {
    for (unsigned j = 0; j < d; ++j) {
      int low = 0, high = 0;
      bool any = false;
      for (unsigned i = 0; i < count + more_count; ++i) {
        const DoubleParts s = double_parts(i < count ? p[i][j] : more[i - count][j]);
        scaled_[std::size_t{i} * d + j] = s;
        if (s.mantissa == 0) continue;
        const int top = s.exponent + bit_length(static_cast<std::uint64_t>(std::abs(s.mantissa)));
        low = any ? std::min(low, s.exponent) : s.exponent;
        high = any ? std::max(high, top) : top;
        any = true;
      }
      exponent_[j] = low;
      bits_ = std::max(bits_, high - low);
    }
  }
  unsigned dimension() const { return d_; }
  /// Every coordinate is below 2^bits() in magnitude.
  int bits() const { return bits_; }
  int exponent(unsigned j) const { return exponent_[j]; }

  /// For bits() <= 62.
  std::int64_t small(unsigned i, unsigned j) const {
    const DoubleParts& s = scaled_[std::size_t{i} * d_ + j];
    return s.mantissa == 0 ? 0 : s.mantissa * (std::int64_t{1} << (s.exponent - exponent_[j]));
  }
  void big(unsigned i, unsigned j, mpz_ptr out) const {
    const DoubleParts& s = scaled_[std::size_t{i} * d_ + j];
    mpz_set_si(out, s.mantissa);
    if (s.mantissa != 0)
      mpz_mul_2exp(out, out, static_cast<mp_bitcnt_t>(s.exponent - exponent_[j]));
  }

 private:
  unsigned d_;
  int bits_ = 0;
  std::vector<DoubleParts> scaled_;
  std::vector<int> exponent_;
};

/// Rows p[i] - p[0]: the matrix of an orientation.
class Differences {
 public:
  Differences(unsigned d, const double* const* p, unsigned rows) : points_(d, p, rows + 1) {}
  unsigned columns() const { return points_.dimension(); }
  bool narrow() const { return points_.bits() <= 62; }  // then a difference fits 64 bits
  int exponent(unsigned j) const { return points_.exponent(j); }
  std::int64_t small(unsigned i, unsigned j) const {
    return points_.small(i + 1, j) - points_.small(0, j);
  }
  void big(unsigned i, unsigned j, mpz_ptr out, mpz_ptr scratch) const {
    points_.big(i + 1, j, out);
    points_.big(0, j, scratch);
    mpz_sub(out, out, scratch);
  }

 private:
  IntegerPoints points_;
};

/// Rows (d + 1) p[i] - sum of the d + 1 points of a simplex.
class CentroidDifferences {
 public:
  CentroidDifferences(unsigned d, const double* const* p, const double* const* simplex)
      : points_(d, p, d, simplex, d + 1) {
    // The sum of d + 1 coordinates and (d + 1) times one each stay below 2^61, so does not
    // overflow.
    narrow_ = points_.bits() + bit_length(d + 1) <= 61;
    if (!narrow_) return;
    sums_.assign(d, 0);
    for (unsigned j = 0; j < d; ++j)
      for (unsigned i = 0; i <= d; ++i) sums_[j] += points_.small(d + i, j);
  }
  unsigned columns() const { return points_.dimension(); }
  bool narrow() const { return narrow_; }
  std::int64_t small(unsigned i, unsigned j) const {
    return static_cast<std::int64_t>(columns() + 1) * points_.small(i, j) - sums_[j];
  }
  void big(unsigned i, unsigned j, mpz_ptr out, mpz_ptr scratch) const {
    const unsigned d = columns();
    points_.big(i, j, out);
    mpz_mul_ui(out, out, d + 1);
    for (unsigned k = 0; k <= d; ++k) {
      points_.big(d + k, j, scratch);
      mpz_sub(out, out, scratch);
    }
  }

 private:
  IntegerPoints points_;
  bool narrow_ = false;
  std::vector<std::int64_t> sums_;
};

/// Determinant in 128 bits, if it provably fits: sum over columns of the bits of their largest
/// entry, plus the bits of d!.
template <unsigned D, class Rows>
bool determinant_128(const Rows& a, Sign& sign) {
  std::int64_t m[D][D];
  int bits = 0;
  for (unsigned j = 0; j < D; ++j) {
    std::uint64_t any = 0;
    for (unsigned i = 0; i < D; ++i) {
      m[i][j] = a.small(i, j);
      any |= static_cast<std::uint64_t>(std::abs(m[i][j]));
    }
    bits += bit_length(any);
  }
  constexpr int factorial_bits[] = {0, 0, 1, 3, 5, 7, 10, 13, 16};
  if (bits + factorial_bits[D] > 126) return false;
  Int128 det[1U << D];
  expand_minors<D, false>(m, D, det, static_cast<Int128*>(nullptr));
  const Int128 value = det[(1U << D) - 1];
  sign = value > 0 ? Sign::positive : value < 0 ? Sign::negative : Sign::zero;
  return true;
}

template <class Rows>
bool determinant_128(const Rows& a, Sign& sign) {
  if (!a.narrow()) return false;
  switch (a.columns()) {
    case 2:
      return determinant_128<2>(a, sign);
    case 3:
      return determinant_128<3>(a, sign);
    case 4:
      return determinant_128<4>(a, sign);
    case 5:
      return determinant_128<5>(a, sign);
    case 6:
      return determinant_128<6>(a, sign);
    case 7:
      return determinant_128<7>(a, sign);
    case 8:
      return determinant_128<8>(a, sign);
    default:
      return false;
  }
}

Pool& pool() {
  thread_local Pool p;
  return p;
}

/// Fraction-free elimination (Bareiss 1968) of an n x n matrix, in place: returns the sign of the
/// row exchanges (0 if singular) and leaves the determinant up to that sign in a[n*n - 1].
int bareiss(mpz_ptr* a, unsigned n, mpz_ptr t) {
  int flips = 1;
  for (unsigned k = 0; k + 1 < n; ++k) {
    unsigned pivot = k;
    while (pivot < n && mpz_sgn(a[std::size_t{pivot} * n + k]) == 0) ++pivot;
    if (pivot == n) return 0;
    if (pivot != k) {
      for (unsigned j = 0; j < n; ++j)
        mpz_swap(a[std::size_t{pivot} * n + j], a[std::size_t{k} * n + j]);
      flips = -flips;
    }
    for (unsigned i = k + 1; i < n; ++i) {
      for (unsigned j = k + 1; j < n; ++j) {
        mpz_ptr x = a[std::size_t{i} * n + j];
        mpz_mul(t, a[std::size_t{i} * n + k], a[std::size_t{k} * n + j]);
        mpz_mul(x, x, a[std::size_t{k} * n + k]);
        mpz_sub(x, x, t);
        if (k > 0) mpz_divexact(x, x, a[std::size_t{k - 1} * n + k - 1]);
      }
    }
  }
  return flips;
}

/// Determinant of the columns `columns[0..n)` of the first n rows; result in *out.
template <class Rows>
void determinant_big(const Rows& a, const unsigned* columns, unsigned n, mpz_ptr out) {
  if (n == 0) {
    mpz_set_ui(out, 1);
    return;
  }
  mpz_ptr* m = pool().take(std::size_t{n} * n + 1);
  mpz_ptr t = m[std::size_t{n} * n];
  for (unsigned i = 0; i < n; ++i)
    for (unsigned j = 0; j < n; ++j) a.big(i, columns[j], m[std::size_t{i} * n + j], t);
  const int flips = bareiss(m, n, t);
  if (flips == 0) {
    mpz_set_ui(out, 0);
    return;
  }
  mpz_set(out, m[std::size_t{n} * n - 1]);
  if (flips < 0) mpz_neg(out, out);
}

/// An mpz_t with a scope.
struct Big {
  Big() { mpz_init(value); }
  ~Big() { mpz_clear(value); }
  Big(const Big&) = delete;
  Big& operator=(const Big&) = delete;
  mpz_t value;
};

template <class Rows>
Sign determinant_sign(const Rows& a) {
  const unsigned d = a.columns();
  Sign sign = Sign::zero;
  if (determinant_128(a, sign)) return sign;
  std::vector<unsigned> columns(d);
  for (unsigned j = 0; j < d; ++j) columns[j] = j;
  Big det;
  determinant_big(a, columns.data(), d, det.value);
  return static_cast<Sign>(mpz_sgn(det.value));
}

}  // namespace

Sign orientation_exact(unsigned d, const double* const* p) {
  return determinant_sign(Differences(d, p, d));
}

Sign orientation_from_centroid_exact(unsigned d, const double* const* p,
                                     const double* const* simplex) {
  return determinant_sign(CentroidDifferences(d, p, simplex));
}

Sign orientation(unsigned d, const double* const* p, Rung* rung) {
  Sign sign = Sign::zero;
  if (filtered(d, p, sign)) {
    if (rung != nullptr) *rung = Rung::filter;
    return sign;
  }
  if (rung != nullptr) *rung = Rung::exact;
  return orientation_exact(d, p);
}

unsigned affine_rank_exact(unsigned d, const double* const* p, unsigned count, unsigned* columns) {
  if (count < 2) return 0;
  const unsigned rows = count - 1;
  const Differences a(d, p, rows);
  mpz_ptr* m = pool().take(std::size_t{rows} * d + 2);
  mpz_ptr t = m[std::size_t{rows} * d];
  mpz_ptr previous = m[std::size_t{rows} * d + 1];
  const auto at = [&](unsigned i, unsigned j) { return m[std::size_t{i} * d + j]; };
  for (unsigned i = 0; i < rows; ++i)
    for (unsigned j = 0; j < d; ++j) a.big(i, j, at(i, j), t);
  // Columns from left to right: the pivots are those of the row echelon form, which depend on the
  // flat alone and not on the points that span it.
  unsigned rank = 0;
  mpz_set_ui(previous, 1);
  for (unsigned c = 0; c < d && rank < rows; ++c) {
    unsigned pivot = rank;
    while (pivot < rows && mpz_sgn(at(pivot, c)) == 0) ++pivot;
    if (pivot == rows) continue;
    for (unsigned j = 0; j < d; ++j) mpz_swap(at(pivot, j), at(rank, j));
    for (unsigned i = rank + 1; i < rows; ++i) {
      for (unsigned j = c + 1; j < d; ++j) {
        mpz_mul(t, at(i, c), at(rank, j));
        mpz_mul(at(i, j), at(i, j), at(rank, c));
        mpz_sub(at(i, j), at(i, j), t);
        mpz_divexact(at(i, j), at(i, j), previous);
      }
      mpz_set_ui(at(i, c), 0);
    }
    mpz_set(previous, at(rank, c));
    if (columns != nullptr) columns[rank] = c;
    ++rank;
  }
  return rank;
}

bool plane_exact(unsigned d, const double* const* p, double* normal) {
  const Differences a(d, p, d - 1);
  std::vector<unsigned> columns(d > 0 ? d - 1 : 0);
  std::vector<long> exponents(d);
  Big det;
  long top = 0;
  bool any = false;
  for (unsigned j = 0; j < d; ++j) {
    double mantissa = 0;
    long e = 0;
    if (d == 3 && a.narrow()) {
      const unsigned u = j == 0 ? 1 : 0, v = j == 2 ? 1 : 2;
      // Entries below 2^63, so each product is below 2^126 and the difference below 2^127.
      const Int128 value =
          Int128{a.small(0, u)} * a.small(1, v) - Int128{a.small(0, v)} * a.small(1, u);
      int ie = 0;
      mantissa = std::frexp(static_cast<double>(value), &ie);
      e = ie;
    } else {
      for (unsigned c = 0, k = 0; c < d; ++c)
        if (c != j) columns[k++] = c;
      determinant_big(a, columns.data(), d - 1, det.value);
      if (mpz_sgn(det.value) != 0) mantissa = mpz_get_d_2exp(&e, det.value);
    }
    normal[j] = ((d - 1 + j) & 1U) != 0 ? -mantissa : mantissa;
    exponents[j] = e - a.exponent(j);
    if (mantissa != 0) {
      top = any ? std::max(top, exponents[j]) : exponents[j];
      any = true;
    }
  }
  if (!any) return false;
  for (unsigned j = 0; j < d; ++j) {
    const long e = std::max(exponents[j] - top, -5000L);
    normal[j] = std::ldexp(normal[j], static_cast<int>(e));
  }
  return true;
}

}  // namespace cullhull::internal
