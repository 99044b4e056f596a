#include "exact/planes/exact_plane.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace cullhull::internal {

BigNumbers::~BigNumbers() {
  for (Number& n : values_) mpz_clear(n.data);
}

void BigNumbers::resize(std::size_t count) {
  while (values_.size() < count) mpz_init(values_.emplace_back().data);
}

/// Fraction-free elimination (Bareiss 1968) with exchanges of rows and columns, then substitution
/// for the null vector whose entry in the column without a pivot is the last pivot: all its entries
/// are minors, hence integers, and every division is exact.
void ExactPlane::set(unsigned d, const double* const* p) {
  d_ = d;
  p_ = p;
  sign_ = 1;
  const unsigned m = d - 1;
  const Differences edges(d, p, m);
  matrix_.resize(std::size_t{m} * d);
  normal_.resize(d);
  scratch_.resize(2);
  column_.resize(d);
  exponent_.resize(d);
  row_.resize(m);
  for (unsigned j = 0; j < d; ++j) {
    column_[j] = j;
    exponent_[j] = edges.exponent(j);
  }
  for (unsigned i = 0; i < m; ++i) {
    row_[i] = std::size_t{i} * d;
    for (unsigned j = 0; j < d; ++j) edges.big(i, j, matrix_[row_[i] + j], scratch_[0]);
  }
  degenerate_ = false;
  for (unsigned r = 0; r < m; ++r) {
    if (!find_pivot(r)) {
      degenerate_ = true;
      return;
    }
    eliminate(r);
  }
  substitute();
}

bool ExactPlane::find_pivot(unsigned r) {
  for (unsigned c = r; c < d_; ++c)
    for (unsigned i = r; i + 1 < d_; ++i) {
      if (mpz_sgn(matrix_[row_[i] + column_[c]]) == 0) continue;
      if (i != r) sign_ = -sign_;
      if (c != r) sign_ = -sign_;
      std::swap(row_[i], row_[r]);
      std::swap(column_[c], column_[r]);
      return true;
    }
  return false;
}

void ExactPlane::eliminate(unsigned r) {
  mpz_ptr t = scratch_[0];
  mpz_ptr pivot = matrix_[row_[r] + column_[r]];
  mpz_ptr previous = r > 0 ? matrix_[row_[r - 1] + column_[r - 1]] : nullptr;
  for (unsigned i = r + 1; i + 1 < d_; ++i) {
    mpz_ptr factor = matrix_[row_[i] + column_[r]];
    for (unsigned j = r + 1; j < d_; ++j)
      fraction_free_step(matrix_[row_[i] + column_[j]], pivot, factor,
                         matrix_[row_[r] + column_[j]], previous, t);
  }
}

void ExactPlane::substitute() {
  const unsigned m = d_ - 1;
  mpz_set(normal_[column_[m]], matrix_[row_[m - 1] + column_[m - 1]]);
  mpz_ptr sum = scratch_[0];
  for (unsigned r = m; r-- > 0;) {
    mpz_set_ui(sum, 0);
    for (unsigned j = r + 1; j <= m; ++j)
      mpz_submul(sum, matrix_[row_[r] + column_[j]], normal_[column_[j]]);
    mpz_divexact(normal_[column_[r]], sum, matrix_[row_[r] + column_[r]]);
  }
  if (sign_ > 0) return;
  for (unsigned j = 0; j < d_; ++j) mpz_neg(normal_[j], normal_[j]);
}

Sign ExactPlane::side(const double* x) {
  return degenerate_ ? Sign::zero : static_cast<Sign>(mpz_sgn(determinant(x).value));
}

ExactPlane::ScaledInteger ExactPlane::cofactor(unsigned j) {
  long all = 0;  // a cofactor has one factor of each other column
  for (unsigned c = 0; c < d_; ++c) all += exponent_[c];
  return {normal_[j], all - exponent_[j]};
}

ExactPlane::ScaledInteger ExactPlane::determinant(const double* x) {
  // Terms normal_[j] (x_j - p_j) have different units: all are converted to the smallest.
  long lowest = std::numeric_limits<long>::max();
  const auto unit = [&](const DoubleParts& a, const DoubleParts& b) {
    return a.mantissa == 0   ? b.exponent
           : b.mantissa == 0 ? a.exponent
                             : std::min(a.exponent, b.exponent);
  };
  for (unsigned j = 0; j < d_; ++j) {
    if (x[j] == p_[0][j]) continue;
    const int e = unit(double_parts(x[j]), double_parts(p_[0][j]));
    lowest = std::min(lowest, static_cast<long>(e) - exponent_[j]);
  }
  mpz_ptr sum = scratch_[0], y = scratch_[1];
  mpz_set_ui(sum, 0);
  for (unsigned j = 0; j < d_; ++j) {
    if (x[j] == p_[0][j] || mpz_sgn(normal_[j]) == 0) continue;
    const DoubleParts a = double_parts(x[j]), b = double_parts(p_[0][j]);
    const int e = unit(a, b);
    mpz_set_si(y, b.mantissa);
    if (b.mantissa != 0) mpz_mul_2exp(y, y, static_cast<mp_bitcnt_t>(b.exponent - e));
    Big first;
    mpz_set_si(first.value, a.mantissa);
    if (a.mantissa != 0)
      mpz_mul_2exp(first.value, first.value, static_cast<mp_bitcnt_t>(a.exponent - e));
    mpz_sub(y, first.value, y);
    mpz_mul_2exp(y, y, static_cast<mp_bitcnt_t>(static_cast<long>(e) - exponent_[j] - lowest));
    mpz_addmul(sum, y, normal_[j]);
  }
  if (mpz_sgn(sum) == 0) return {sum, 0};
  for (unsigned c = 0; c < d_; ++c) lowest += exponent_[c];
  return {sum, lowest};
}

void ExactPlane::normal(double* out) {
  std::vector<long> exponents(d_);
  for (unsigned j = 0; j < d_; ++j) {
    out[j] = mpz_get_d_2exp(&exponents[j], normal_[j]);
    exponents[j] -= exponent_[j];
  }
  scale_normal(d_, out, exponents.data());
}

bool scale_normal(unsigned d, double* mantissa, const long* exponent) {
  long top = std::numeric_limits<long>::min();
  for (unsigned j = 0; j < d; ++j)
    if (mantissa[j] != 0) top = std::max(top, exponent[j]);
  for (unsigned j = 0; j < d; ++j)
    if (mantissa[j] != 0)
      mantissa[j] = std::ldexp(mantissa[j], static_cast<int>(std::max(exponent[j] - top, -5000L)));
  return top != std::numeric_limits<long>::min();
}

void OrientedPlane::set(unsigned d, const double* const* p) {
  d_ = d;
  p_.assign(p, p + d);
  exact_set_ = false;
  refined_ = Refined::untried;
  eliminated_ = plane_.set(d, p_.data());
}

Sign OrientedPlane::side(const double* x, Rung* rung) {
  if (rung != nullptr) *rung = Rung::filter;
  bool known = false;
  if (eliminated_) {
    const Sign sign = plane_.side(x, known);
    if (known) return sign;
  }
  if (surely_zero(x)) return Sign::zero;
  if (eliminated_ && refined_ == Refined::untried)
    refined_ = plane_.refine() ? Refined::yes : Refined::no;
  if (refined_ == Refined::yes) {
    const Sign sign = plane_.refined_side(x, known);
    if (known) return sign;
  }
  if (rung != nullptr) *rung = Rung::exact;
  return exact().side(x);
}

bool OrientedPlane::proper() { return eliminated_ || !exact().degenerate(); }

/// Whether all points are on a plane orthogonal to an axis, or two of them are equal.
bool OrientedPlane::surely_zero(const double* x) const {
  for (unsigned j = 0; j < d_; ++j)
    if (std::all_of(p_.begin(), p_.end(), [&](const double* q) { return q[j] == x[j]; }))
      return true;
  return std::any_of(p_.begin(), p_.end(),
                     [&](const double* q) { return std::equal(q, q + d_, x); });
}

ExactPlane& OrientedPlane::exact() {
  if (!exact_set_) exact_.set(d_, p_.data());
  exact_set_ = true;
  return exact_;
}

}  // namespace cullhull::internal
