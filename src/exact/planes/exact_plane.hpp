// The hyperplane through d points in exact integers: one elimination, then a dot product for each
// point.
#pragma once

#include <gmp.h>

#include <vector>

#include "exact/orientation/orientation.hpp"
#include "exact/planes/eliminated_plane.hpp"
#include "exact/points/integer_points.hpp"

namespace cullhull::internal::inline exact {

/// One entry of a step of fraction-free elimination (Bareiss 1968): x = (x pivot - factor top) /
/// previous, where previous is the pivot before (null for the first step). Every division is exact.
inline void fraction_free_step(mpz_ptr x, mpz_srcptr pivot, mpz_srcptr factor, mpz_srcptr top,
                               mpz_srcptr previous, mpz_ptr scratch) {
  mpz_mul(scratch, factor, top);
  mpz_mul(x, x, pivot);
  mpz_sub(x, x, scratch);
  if (previous != nullptr) mpz_divexact(x, x, previous);
}

/// Integers of GMP that keep their memory from one computation to the next.
class BigNumbers {
 public:
  BigNumbers() = default;
  BigNumbers(const BigNumbers&) = delete;
  BigNumbers& operator=(const BigNumbers&) = delete;
  BigNumbers(BigNumbers&&) = default;
  BigNumbers& operator=(BigNumbers&&) = default;
  ~BigNumbers();
  /// At least `count` numbers from here on; those there keep their values.
  void resize(std::size_t count);
  mpz_ptr operator[](std::size_t i) { return values_[i].data; }

 private:
  struct Number {
    mpz_t data;
  };
  std::vector<Number> values_;
};

/// Components mantissa[j] 2^exponent[j] (the mantissas 0 or in [0.5, 1) in magnitude), scaled alike
/// so that the largest is in [0.5, 1], into `mantissa`. False if all are zero.
bool scale_normal(unsigned d, double* mantissa, const long* exponent);

/// Cofactors of the edges from p[0], column j in units of a power of two.
class ExactPlane {
 public:
  /// Through p[0..d), any finite doubles, d >= 2. O(d^3) operations on integers of up to about
  /// 60 d bits. `p` must outlive the plane.
  void set(unsigned d, const double* const* p);
  /// Whether the points are affinely dependent; then every sign is zero.
  bool degenerate() const { return degenerate_; }
  /// Sign of orientation(p[0], ..., p[d-1], x). O(d) operations.
  Sign side(const double* x);
  /// A number of the plane is `value` times 2^`exponent`, exactly; valid until the next call.
  struct ScaledInteger {
    mpz_srcptr value;
    long exponent;
  };
  /// The determinant whose sign side() returns: `cofactor`s times x - p[0].
  ScaledInteger determinant(const double* x);
  /// Component j of the normal. Requires independent points.
  ScaledInteger cofactor(unsigned j);
  /// The normal in doubles, as plane_exact gives it. Requires independent points.
  void normal(double* out);

 private:
  bool find_pivot(unsigned r);
  void eliminate(unsigned r);
  void substitute();

  unsigned d_ = 0;
  const double* const* p_ = nullptr;
  bool degenerate_ = false;
  int sign_ = 1;  // of the exchanges
  std::vector<unsigned> column_;
  std::vector<int> exponent_;
  std::vector<std::size_t> row_;  // where the rows of the matrix begin
  BigNumbers matrix_, normal_;    // (d - 1) x d; by axis
  BigNumbers scratch_;
};

// The ladder for one hyperplane and many points, in any dimension: what a rung computes for the
// plane is computed once.

/// From this dimension on an elimination, O(d^3), is faster than the 2^d minors of an expansion.
inline constexpr unsigned elimination_pays = 7;

class OrientedPlane {
 public:
  /// Through p[0..d), d >= 2. The coordinates must outlive the plane, the pointers need not.
  void set(unsigned d, const double* const* p);
  /// Sign of orientation(p[0], ..., p[d-1], x), exactly; `rung`, if given, receives what decided:
  /// Rung::filter for doubles and double-doubles, Rung::exact for integers.
  Sign side(const double* x, Rung* rung = nullptr);
  /// Whether p[0..d) are affinely independent, exactly.
  bool proper();

 private:
  bool surely_zero(const double* x) const;
  ExactPlane& exact();

  unsigned d_ = 0;
  std::vector<const double*> p_;
  bool eliminated_ = false, exact_set_ = false;
  enum class Refined : unsigned char { untried, yes, no } refined_ = Refined::untried;
  EliminatedPlane plane_;
  ExactPlane exact_;
};

}  // namespace cullhull::internal::inline exact
