// Ranks and signs of determinants from residues modulo primes, against rational elimination.
#include "exact/determinants/modular.hpp"

#include <gmpxx.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <random>
#include <utility>
#include <vector>

#include "exact/orientation/orientation.hpp"
#include "slow_elimination.hpp"

namespace cullhull::internal {
namespace modular_test {

struct Integers {
  unsigned rows, columns;
  std::vector<mpz_class> entries;
};

/// The pivots' columns of the row echelon form, and the determinant's sign of a square matrix.
std::pair<std::vector<unsigned>, Sign> slowly(const Integers& m) {
  std::vector<testing_support::Rationals> a(m.rows, testing_support::Rationals(m.columns));
  for (std::size_t i = 0; i < m.entries.size(); ++i) a[i / m.columns][i % m.columns] = m.entries[i];
  mpq_class determinant;
  std::vector<unsigned> pivots = testing_support::echelon(a, &determinant);
  return {pivots, static_cast<Sign>(sgn(determinant))};
}

BigNumbers numbers_of(const Integers& m) {
  BigNumbers out;
  out.resize(m.entries.size());
  for (std::size_t i = 0; i < m.entries.size(); ++i) mpz_set(out[i], m.entries[i].get_mpz_t());
  return out;
}

void expect_as_slowly(const Integers& m, const char* what) {
  const auto [pivots, sign] = slowly(m);
  BigNumbers numbers = numbers_of(m);
  std::vector<unsigned> found(std::min(m.rows, m.columns));
  const unsigned rank = rank_by_primes(numbers, m.rows, m.columns, found.data());
  ASSERT_EQ(rank, pivots.size()) << what;
  found.resize(rank);
  EXPECT_EQ(found, pivots) << what;
  if (m.rows == m.columns) {
    EXPECT_EQ(determinant_sign_by_primes(numbers, m.rows), sign) << what;
  }
}

Integers random_integers(std::mt19937_64& random, unsigned rows, unsigned columns, unsigned bits) {
  Integers m{rows, columns, {}};
  for (unsigned i = 0; i < rows * columns; ++i) {
    mpz_class v = 0;
    for (unsigned b = 0; b < bits; b += 32) v = (v << 32) + static_cast<unsigned>(random());
    v %= mpz_class(1) << bits;
    m.entries.push_back(random() % 2 == 0 ? v : mpz_class(-v));
  }
  return m;
}

TEST(Modular, RanksAndSignsOfRandomMatrices) {
  std::mt19937_64 random(1);
  for (unsigned run = 0; run < 400; ++run) {
    const unsigned rows = 1 + static_cast<unsigned>(random() % 7),
                   columns = random() % 2 == 0 ? rows : 1 + static_cast<unsigned>(random() % 7);
    const unsigned bits[] = {1, 2, 30, 31, 32, 64, 200};
    Integers m = random_integers(random, rows, columns, bits[random() % 7]);
    const auto at = [&](unsigned i, unsigned j) -> mpz_class& {
      return m.entries[i * columns + j];
    };
    if (rows > 1 && random() % 2 == 0)  // a row, or a column, that depends on others
      for (unsigned j = 0; j < columns; ++j) at(rows - 1, j) = 3 * at(0, j) - at(rows / 2, j);
    if (columns > 1 && random() % 3 == 0)
      for (unsigned i = 0; i < rows; ++i) at(i, 1) = 2 * at(i, 0);
    if (random() % 4 == 0)
      for (unsigned i = 0; i < rows; ++i) at(i, 0) = 0;
    expect_as_slowly(m, "random");
  }
}

/// The first primes that are tried divide the determinant, or leading minors.
TEST(Modular, PrimesThatDivideMinors) {
  mpz_class p = (mpz_class(1) << 31) - 1, product = 1;
  for (int i = 0; i < 3; ++i) {
    while (mpz_probab_prime_p(p.get_mpz_t(), 24) == 0) p -= 2;
    product *= p;
    p -= 2;
    for (const int sign : {1, -1}) {
      expect_as_slowly({2, 2, {sign * product, 1, 0, 1}}, "determinant");
      expect_as_slowly({2, 3, {sign * product, 1, 0, 0, 0, 1}}, "leading minor");
      expect_as_slowly({3, 3, {product, 0, 1, product, sign, 0, 0, product, product}}, "minors");
    }
  }
}

/// The largest determinant that Hadamard's bound allows, of either sign.
TEST(Modular, DeterminantsAsLargeAsTheirBound) {
  for (unsigned n = 1; n <= 16; n *= 2)
    for (const int sign : {1, -1}) {
      Integers m{n, n, std::vector<mpz_class>(n * n, 1)};
      for (unsigned i = 0; i < n; ++i)
        for (unsigned j = 0; j < n; ++j)
          m.entries[i * n + j] =
              ((std::popcount(i & j) % 2 == 0) == (j > 0 || sign > 0) ? 1 : -1) * 0x7fffffffL;
      expect_as_slowly(m, "Hadamard");
    }
}

/// By the doors through which the library asks, in dimensions where residues take over.
TEST(Modular, OrientationsAndFlatsInManyDimensions) {
  std::mt19937_64 random(7);
  for (const unsigned d : {15U, 16U, 24U, 30U}) {
    std::vector<std::vector<double>> points(d + 1, std::vector<double>(d));
    for (auto& p : points)
      for (double& x : p) x = std::ldexp(static_cast<double>(random() >> 11), -53);
    std::vector<const double*> rows;
    for (const auto& p : points) rows.push_back(p.data());
    const Sign sign = orientation_exact(d, rows.data());
    EXPECT_NE(sign, Sign::zero);
    EXPECT_EQ(orientation(d, rows.data()), sign);
    std::swap(rows[0], rows[d]);
    EXPECT_EQ(orientation_exact(d, rows.data()), -sign);
    EXPECT_EQ(affine_rank_exact(d, rows.data(), d + 1), d);
    // The last point between two others: one dimension less.
    for (unsigned c = 0; c < d; ++c) {
      points[1][c] = std::round(points[1][c] * 1024);
      points[2][c] = std::round(points[2][c] * 1024);
      points[d][c] = (points[1][c] + points[2][c]) / 2;
    }
    EXPECT_EQ(orientation_exact(d, rows.data()), Sign::zero);
    std::vector<unsigned> columns(d);
    EXPECT_EQ(affine_rank_exact(d, rows.data(), d + 1, columns.data()), d - 1);
    for (unsigned c = 0; c + 1 < d; ++c) EXPECT_EQ(columns[c], c);
  }
}

}  // namespace modular_test
}  // namespace cullhull::internal
