// The hyperplane through d points in exact integers: one elimination, then a dot product per point.
//
// An OrientedPlane asks the cheapest rung first: a plane by elimination in doubles (O(d^3) once,
// O(d) a point), then refined, then these exact cofactors. All of them answer the same question, so
// which rung decides shows in the counts alone.
#pragma once

#include <gmp.h>

#include <vector>

#include "exact/orientation/orientation.hpp"
#include "exact/planes/eliminated_plane.hpp"
#include "exact/points/integer_points.hpp"

namespace cullhull::internal {

/// GMP integers that keep their memory from one computation to the next.
class BigNumbers {
 public:
  BigNumbers() = default;
  BigNumbers(const BigNumbers&) = delete;
  BigNumbers& operator=(const BigNumbers&) = delete;
  BigNumbers(BigNumbers&&) = default;
  BigNumbers& operator=(BigNumbers&&) = default;
  ~BigNumbers();
  /// Provides at least `count` numbers; existing ones keep their values.
  void resize(std::size_t count);
  mpz_ptr operator[](std::size_t i) { return values_[i].data; }

 private:
  struct Number {
    mpz_t data;
  };
  std::vector<Number> values_;
};

/// Brings the matrix of integers m[i * columns + j] to row echelon form by fraction-free
/// elimination (Bareiss 1968), whose divisions are exact: entry j of row r becomes a minor of the
/// first r + 1 rows, on the pivots' columns before it and column j. Returns the rank. `pivots`, if
/// given, receives the pivots' columns, ascending, `sign` the parity of the exchanges of rows as 1
/// or -1. `full`: ends early if the rank is certainly less than `rows`. m has room for one number
/// more.
unsigned echelon_form(BigNumbers& m, unsigned rows, unsigned columns, bool full, unsigned* pivots,
                      int* sign = nullptr);

/// Scales the components mantissa[j] 2^exponent[j] (the mantissas 0 or in [0.5, 1) in magnitude)
/// alike so that the largest is in [0.5, 1], into `mantissa`. Returns false if all are zero.
bool scale_normal(unsigned d, double* mantissa, const long* exponent);

/// A plane's normal: the cofactors of the edges from p[0], column j in units of a power of two.
class ExactPlane {
 public:
  /// Finds the plane through p[0..d), any finite doubles, d >= 2. O(d^3) operations on integers of
  /// up to about 60 d bits. `p` must outlive the plane.
  void set(unsigned d, const double* const* p);
  /// Whether the points are affinely dependent; then every sign is zero.
  bool degenerate() const { return degenerate_; }
  /// Returns the sign of orientation(p[0], ..., p[d-1], x). O(d) operations.
  Sign side(const double* x);
  /// A number of the plane: exactly `value` times 2^`exponent`; valid until the next call.
  struct ScaledInteger {
    mpz_srcptr value;
    long exponent;
  };
  /// Returns the determinant whose sign side() returns: `cofactor`s times x - p[0].
  ScaledInteger determinant(const double* x);
  /// Returns component j of the normal. Requires independent points.
  ScaledInteger cofactor(unsigned j);
  /// Computes the normal in doubles, like plane_exact. Requires independent points.
  void normal(double* out);

 private:
  unsigned d_ = 0;
  const double* const* p_ = nullptr;
  bool degenerate_ = false;
  std::vector<unsigned> pivots_;
  std::vector<int> exponent_;
  BigNumbers matrix_, normal_;  // (d - 1) x d, in echelon form; by axis
  BigNumbers scratch_;
};

// The ladder for one hyperplane and many points, in any dimension: each rung prepares the plane
// only once.

/// From this dimension on an elimination, O(d^3), is faster than expanding 2^d minors.
inline constexpr unsigned elimination_pays = 7;

class OrientedPlane {
 public:
  /// Sets the plane through p[0..d), d >= 2. The coordinates must outlive the plane, the pointers
  /// need not.
  void set(unsigned d, const double* const* p);
  /// Returns the sign of orientation(p[0], ..., p[d-1], x), exactly; `rung`, if given, receives the
  /// rung that decided: Rung::filter for doubles and double-doubles, Rung::exact for integers.
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

}  // namespace cullhull::internal
