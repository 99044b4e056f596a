#include "exact/determinants/modular.hpp"

#include <gmp.h>

#include <algorithm>
#include <bit>
#include <cstdint>
#include <functional>
#include <vector>

#include "exact/numbers/gmpxx.hpp"

namespace cullhull::internal {
namespace {

/// Arithmetic modulo an odd prime below 2^31, on residues times 2^32.
/// Source: P. Montgomery, "Modular multiplication without trial division", Mathematics of
/// Computation 44 (1985).
class Field {
 public:
  explicit Field(std::uint32_t p) : p_(p) {
    std::uint32_t inverse = p;  // modulo 8; each step doubles the bits
    for (int i = 0; i < 4; ++i) inverse *= 2 - p * inverse;
    negative_inverse_ = -inverse;
    one_ = static_cast<std::uint32_t>((std::uint64_t{1} << 32) % p);
    square_ = static_cast<std::uint32_t>(std::uint64_t{one_} * one_ % p);
  }
  std::uint32_t prime() const { return p_; }
  std::uint32_t one() const { return one_; }
  std::uint32_t from(std::uint32_t v) const { return times(v, square_); }
  std::uint32_t value(std::uint32_t a) const { return reduce(a); }
  std::uint32_t times(std::uint32_t a, std::uint32_t b) const {
    return reduce(std::uint64_t{a} * b);
  }
  std::uint32_t minus(std::uint32_t a, std::uint32_t b) const { return a - b + (a < b ? p_ : 0); }
  std::uint32_t inverse(std::uint32_t a) const {
    std::uint32_t result = one_;
    for (std::uint32_t e = p_ - 2; e != 0; e >>= 1, a = times(a, a))
      if ((e & 1) != 0) result = times(result, a);
    return result;
  }

 private:
  // Montgomery's reduction: m is chosen so that v + m p is a multiple of 2^32, so the shift is
  // exact, and v + m p < 2^32 (2 p) leaves a result below 2 p. Example with 2^4 in place of 2^32
  // and p = 7: -1 / 7 modulo 16 is 9; v = 10 gives m = 10 * 9 mod 16 = 10, (10 + 70) / 16 = 5, and
  // indeed 5 * 16 = 80 = 10 modulo 7.

  /// v / 2^32, for v < 2^32 p.
  std::uint32_t reduce(std::uint64_t v) const {
    const std::uint32_t m = static_cast<std::uint32_t>(v) * negative_inverse_;
    const auto r = static_cast<std::uint32_t>((v + std::uint64_t{m} * p_) >> 32);
    return r - (r >= p_ ? p_ : 0);
  }
  std::uint32_t p_, negative_inverse_ = 0, one_ = 0, square_ = 0;
};

/// The primes below 2^31, descending. For numbers of that size GMP's test is a proof.
class Primes {
 public:
  std::uint32_t next() {
    do {
      last_ -= 2;
      mpz_set_ui(candidate_.get_mpz_t(), last_);
    } while (mpz_probab_prime_p(candidate_.get_mpz_t(), 24) == 0);
    return last_;
  }

 private:
  mpz_class candidate_;
  std::uint32_t last_ = (std::uint32_t{1} << 31) + 1;
};
constexpr std::size_t bits_per_prime = 30;

/// Row echelon form modulo a prime.
class Residues {
 public:
  Residues(BigNumbers& m, unsigned rows, unsigned columns, std::uint32_t prime)
      : field_(prime), rows_(rows), columns_(columns), a_(std::size_t{rows} * columns) {
    for (std::size_t i = 0; i < a_.size(); ++i)
      a_[i] = field_.from(static_cast<std::uint32_t>(mpz_fdiv_ui(m[i], field_.prime())));
  }

  /// Returns the pivots' columns. Ends at the first column without one where `square`.
  std::vector<unsigned> eliminate(bool square) {
    std::vector<unsigned> pivots;
    determinant_ = field_.one();
    for (unsigned c = 0; c < columns_ && pivots.size() < rows_; ++c) {
      const auto rank = static_cast<unsigned>(pivots.size());
      unsigned pivot = rank;
      while (pivot < rows_ && row(pivot)[c] == 0) ++pivot;
      if (pivot == rows_) {
        determinant_ = 0;
        if (square) return pivots;
        continue;
      }
      if (pivot != rank) {
        std::swap_ranges(row(pivot), row(pivot) + columns_, row(rank));
        determinant_ = field_.minus(0, determinant_);
      }
      const std::uint32_t* const above = row(rank);
      determinant_ = field_.times(determinant_, above[c]);
      const std::uint32_t inverse = field_.inverse(above[c]);
      for (unsigned i = rank + 1; i < rows_; ++i) {
        std::uint32_t* const below = row(i);
        if (below[c] == 0) continue;
        const std::uint32_t factor = field_.times(below[c], inverse);
        for (unsigned j = c + 1; j < columns_; ++j)
          below[j] = field_.minus(below[j], field_.times(factor, above[j]));
      }
      pivots.push_back(c);
    }
    return pivots;
  }
  std::uint32_t determinant() const { return field_.value(determinant_); }

 private:
  std::uint32_t* row(unsigned i) { return a_.data() + std::size_t{i} * columns_; }

  Field field_;
  unsigned rows_, columns_;
  std::vector<std::uint32_t> a_;
  std::uint32_t determinant_ = 0;
};

// Example: a 24 x 24 matrix of 20-bit entries: 24 * 20 + 24 * 5 / 2 + 1 = 541 bits, so 19 primes of
// 30 bits and more are enough, each an elimination of 24^3 / 3 steps.

/// The bits of the largest minor, by Hadamard's inequality: the lengths of the longest columns.
std::size_t bits_of_minors(BigNumbers& m, unsigned rows, unsigned columns) {
  std::vector<std::size_t> bits(columns, 0);
  for (unsigned i = 0; i < rows; ++i)
    for (unsigned j = 0; j < columns; ++j)
      bits[j] = std::max(bits[j], mpz_sizeinbase(m[std::size_t{i} * columns + j], 2));
  std::sort(bits.begin(), bits.end(), std::greater<>());
  const unsigned order = std::min(rows, columns);
  std::size_t sum = 1;
  for (unsigned j = 0; j < order; ++j) sum += bits[j];
  // Half of order log2(order), for columns of `order` such entries.
  return sum + (std::size_t{order} * static_cast<std::size_t>(std::bit_width(order)) + 1) / 2;
}

}  // namespace

unsigned rank_by_primes(BigNumbers& m, unsigned rows, unsigned columns, unsigned* pivots) {
  const std::size_t enough = bits_of_minors(m, rows, columns) / bits_per_prime + 1;
  const unsigned most = std::min(rows, columns);
  Primes primes;
  // A minor that is not zero is not zero modulo one of enough primes, and never the other way
  // round: the rank of the first c columns is the largest one modulo any of them.
  std::vector<unsigned> ranks(columns + 1, 0);
  for (std::size_t i = 0; i < enough; ++i) {
    const auto found = Residues(m, rows, columns, primes.next()).eliminate(false);
    unsigned rank = 0;
    for (unsigned c = 0; c < columns; ++c) {
      if (rank < found.size() && found[rank] == c) ++rank;
      ranks[c + 1] = std::max(ranks[c + 1], rank);
    }
    if (ranks[most] == most) break;  // no rank can be larger
  }
  unsigned rank = 0;
  for (unsigned c = 0; c < columns; ++c)
    if (ranks[c + 1] > rank) {
      if (pivots != nullptr) pivots[rank] = c;
      ++rank;
    }
  return rank;
}

Sign determinant_sign_by_primes(BigNumbers& m, unsigned n) {
  const std::size_t enough = (bits_of_minors(m, n, n) + 1) / bits_per_prime + 1;
  Primes primes;
  // Between 0 and the product of the primes so far, and congruent to the determinant. In the end it
  // is more than half of the product where the determinant is negative.
  mpz_class value = 0, product = 1;
  for (std::size_t i = 0; i < enough; ++i) {
    const std::uint32_t p = primes.next();
    const Field field(p);
    const auto residue = [&](const mpz_class& v) {
      return field.from(static_cast<std::uint32_t>(mpz_fdiv_ui(v.get_mpz_t(), p)));
    };
    Residues residues(m, n, n, p);
    residues.eliminate(true);
    const std::uint32_t missing = field.minus(field.from(residues.determinant()), residue(value));
    const std::uint32_t digit = field.value(field.times(missing, field.inverse(residue(product))));
    mpz_addmul_ui(value.get_mpz_t(), product.get_mpz_t(), digit);
    product *= static_cast<unsigned long>(p);
  }
  if (value == 0) return Sign::zero;
  return 2 * value > product ? Sign::negative : Sign::positive;
}

}  // namespace cullhull::internal
