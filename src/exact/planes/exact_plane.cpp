#include "exact/planes/exact_plane.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace cullhull::internal {

BigNumbers::~BigNumbers() {
  for (Number& n : values_) mpz_clear(n.data);
}

void BigNumbers::resize(std::size_t count) {
  while (values_.size() < count) mpz_init(values_.emplace_back().data);
}

unsigned echelon_form(BigNumbers& m, unsigned rows, unsigned columns, bool full, unsigned* pivots,
                      int* sign) {
  const auto at = [&](unsigned i, unsigned j) { return m[std::size_t{i} * columns + j]; };
  mpz_ptr scratch = m[std::size_t{rows} * columns], previous = nullptr;
  if (sign != nullptr) *sign = 1;
  unsigned rank = 0;
  for (unsigned c = 0; c < columns && rank < rows; ++c) {
    unsigned pivot = rank;
    while (pivot < rows && mpz_sgn(at(pivot, c)) == 0) ++pivot;
    if (pivot == rows) {
      if (full && columns - c - 1 < rows - rank) return rank;
      continue;
    }
    if (pivot != rank) {
      for (unsigned j = 0; j < columns; ++j) mpz_swap(at(pivot, j), at(rank, j));
      if (sign != nullptr) *sign = -*sign;
    }
    for (unsigned i = rank + 1; i < rows; ++i) {
      for (unsigned j = c + 1; j < columns; ++j) {  // (x pivot - factor top) / previous
        mpz_mul(scratch, at(i, c), at(rank, j));
        mpz_mul(at(i, j), at(i, j), at(rank, c));
        mpz_sub(at(i, j), at(i, j), scratch);
        if (previous != nullptr) mpz_divexact(at(i, j), at(i, j), previous);
      }
      mpz_set_ui(at(i, c), 0);
    }
    previous = at(rank, c);
    if (pivots != nullptr) pivots[rank] = c;
    ++rank;
  }
  return rank;
}

// Example in the plane: p_0 = (1, 2), p_1 = (4, 3). The only edge is (3, 1); its pivot is 3 in
// column 0, so column 1 has none, and the null vector with the last pivot in that column is (-1,
// 3): 3 * (-1) + 1 * 3 = 0. It is the normal, and the side of x = (0, 0) is the sign of (-1)(0 - 1)
// + 3 (0 - 2) = -5. A second point costs only such a dot product.

/// Elimination, then substitution for the null vector whose entry in the column without a pivot is
/// the last pivot: all its entries are minors, hence integers, and every division is exact.
void ExactPlane::set(unsigned d, const double* const* p) {
  d_ = d;
  p_ = p;
  const unsigned m = d - 1;
  const Differences edges(d, p, m);
  matrix_.resize(std::size_t{m} * d + 1);
  normal_.resize(d);
  scratch_.resize(3);
  pivots_.resize(m);
  exponent_.resize(d);
  for (unsigned j = 0; j < d; ++j) exponent_[j] = edges.exponent(j);
  for (unsigned i = 0; i < m; ++i)
    for (unsigned j = 0; j < d; ++j) edges.big(i, j, matrix_[std::size_t{i} * d + j], scratch_[0]);
  int sign = 1;
  degenerate_ = echelon_form(matrix_, m, d, true, pivots_.data(), &sign) < m;
  if (degenerate_) return;
  unsigned open = 0;  // the column without a pivot
  while (open < m && pivots_[open] == open) ++open;
  if ((m - open) % 2 == 1) sign = -sign;
  const auto at = [&](unsigned i, unsigned j) { return matrix_[std::size_t{i} * d + j]; };
  mpz_set(normal_[open], at(m - 1, pivots_[m - 1]));
  mpz_ptr sum = scratch_[0];
  for (unsigned r = m; r-- > 0;) {
    mpz_set_ui(sum, 0);
    for (unsigned j = pivots_[r] + 1; j < d; ++j) mpz_submul(sum, at(r, j), normal_[j]);
    mpz_divexact(normal_[pivots_[r]], sum, at(r, pivots_[r]));
  }
  if (sign > 0) return;
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
  mpz_ptr sum = scratch_[0], y = scratch_[1], first = scratch_[2];
  mpz_set_ui(sum, 0);
  for (unsigned j = 0; j < d_; ++j) {
    if (x[j] == p_[0][j] || mpz_sgn(normal_[j]) == 0) continue;
    const DoubleParts a = double_parts(x[j]), b = double_parts(p_[0][j]);
    const int e = unit(a, b);
    set_in_units(y, b, e);
    set_in_units(first, a, e);
    mpz_sub(y, first, y);
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
