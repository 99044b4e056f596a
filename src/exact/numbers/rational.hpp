// Rational numbers with destructors, and small systems of them.
#pragma once

#include <gmp.h>

#include <cstddef>
#include <memory>

namespace cullhull::internal::inline exact {

struct Rational {
  Rational() { mpq_init(value); }
  ~Rational() { mpq_clear(value); }
  Rational(const Rational&) = delete;
  Rational& operator=(const Rational&) = delete;
  mpq_t value;
};

class RationalMatrix {
 public:
  RationalMatrix(std::size_t rows, std::size_t columns)
      : rows_(rows), columns_(columns), items_(std::make_unique<Rational[]>(rows * columns)) {}
  mpq_ptr at(std::size_t i, std::size_t j) { return items_[i * columns_ + j].value; }

  /// Whether the system, its right-hand side in the last column, has exactly one solution and that
  /// has no negative component. Overwrites the matrix.
  bool solves_without_negatives() {
    const std::size_t n = columns_ - 1;
    Rational f, t;
    for (std::size_t k = 0; k < n; ++k) {
      std::size_t pivot = k;
      while (pivot < rows_ && mpq_sgn(at(pivot, k)) == 0) ++pivot;
      if (pivot >= rows_) return false;
      for (std::size_t j = 0; j < columns_; ++j) mpq_swap(at(pivot, j), at(k, j));
      for (std::size_t i = 0; i < rows_; ++i) {
        if (i == k || mpq_sgn(at(i, k)) == 0) continue;
        mpq_div(f.value, at(i, k), at(k, k));
        for (std::size_t j = k; j < columns_; ++j) {
          mpq_mul(t.value, f.value, at(k, j));
          mpq_sub(at(i, j), at(i, j), t.value);
        }
      }
    }
    for (std::size_t i = n; i < rows_; ++i)
      if (mpq_sgn(at(i, n)) != 0) return false;
    for (std::size_t k = 0; k < n; ++k)
      if (mpq_sgn(at(k, n)) * mpq_sgn(at(k, k)) < 0) return false;
    return true;
  }

 private:
  std::size_t rows_, columns_;
  std::unique_ptr<Rational[]> items_;
};

}  // namespace cullhull::internal::inline exact
