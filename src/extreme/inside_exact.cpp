// The simplex method, phase one, in rational arithmetic with Bland's rule (1977), which never
// cycles.
//
// It finds w >= 0 with sum w_q (q - p) = 0 and sum w_q = 1. The first basis has one artificial
// variable per row; their sum reaches zero exactly if p is in the hull. The inverse of the basis is
// stored.
#include <cmath>
#include <vector>

#include "exact/determinants/minors.hpp"
#include "exact/numbers/rationals.hpp"
#include "extreme/hull_membership.hpp"

namespace cullhull::internal {
namespace {

class Simplex {
 public:
  Simplex(const LocalPoints& points, std::uint32_t point, const std::vector<std::uint32_t>& others,
          const Control& control)
      : points_(points),
        others_(others),
        control_(control),
        point_(point),
        rows_(points.dimension + 1),
        inverse_(rows_, std::vector<mpq_class>(rows_ + 1)),
        column_(rows_),
        entering_(rows_),
        prices_(rows_),
        basis_(rows_) {
    for (std::size_t i = 0; i < rows_; ++i) {
      inverse_[i][i] = 1;
      basis_[i] = others.size() + i;  // artificial
    }
    inverse_[rows_ - 1][rows_] = 1;  // the last column contains the basic values
  }

  bool feasible() {
    for (;;) {
      control_.check();
      if (done()) return true;
      price();
      const std::size_t q = improving();
      if (q == others_.size()) return false;
      pivot(q);
    }
  }

 private:
  bool artificial(std::size_t variable) const { return variable >= others_.size(); }

  bool done() {
    for (std::size_t i = 0; i < rows_; ++i)
      if (artificial(basis_[i]) && sgn(inverse_[i][rows_]) != 0) return false;
    return true;
  }

  /// Sets prices to the sum of the rows of the inverse whose basic variable is artificial.
  void price() {
    rounded_.assign(rows_, 0.0);
    rounded_size_ = 0;
    for (std::size_t j = 0; j < rows_; ++j) {
      prices_[j] = 0;
      for (std::size_t i = 0; i < rows_; ++i)
        if (artificial(basis_[i])) prices_[j] += inverse_[i][j];
      rounded_[j] = prices_[j].get_d();  // towards zero: within 2u
      rounded_size_ += std::abs(rounded_[j]);
    }
  }

  void load(std::size_t q) {
    const double* x = points_.exact_row(others_[q]);
    const double* p = points_.exact_row(point_);
    for (std::size_t j = 0; j + 1 < rows_; ++j) {
      column_[j] = x[j];
      t_ = p[j];
      column_[j] -= t_;
    }
    column_[rows_ - 1] = 1;
  }

  /// Sets sum to row . column_.
  void dot_column(const std::vector<mpq_class>& row, mpq_class& sum) {
    sum = 0;
    for (std::size_t j = 0; j < rows_; ++j) {
      t_ = row[j] * column_[j];
      sum += t_;
    }
  }

  /// Returns the first column with prices . column > 0. Skips columns that doubles prove negative.
  std::size_t improving() {
    const bool floating = points_.exact == points_.coordinates && std::isfinite(rounded_size_);
    // |column| <= 2, each difference and product and sum rounded, prices within 2u.
    const double bound =
        2 * (static_cast<double>(rows_) + 8) * unit_roundoff * rounded_size_ + 0x1p-1000;
    const double* p = points_.row(point_);
    for (std::size_t q = 0; q < others_.size(); ++q) {
      if (others_[q] == point_) continue;
      if (q % 4096 == 4095) control_.check();
      if (floating) {
        const double* x = points_.row(others_[q]);
        double sum = rounded_[rows_ - 1];
        for (std::size_t j = 0; j + 1 < rows_; ++j) sum += rounded_[j] * (x[j] - p[j]);
        if (sum < -bound) continue;
      }
      load(q);
      dot_column(prices_, sum_);
      if (sgn(sum_) > 0) return q;
    }
    return others_.size();
  }

  void pivot(std::size_t q) {
    load(q);
    for (std::size_t i = 0; i < rows_; ++i) dot_column(inverse_[i], entering_[i]);
    // The row of least ratio leaves, among equals that of the lowest variable (Bland). One exists,
    // because the sum of the artificial variables is bounded below.
    std::size_t leaving = rows_;
    for (std::size_t i = 0; i < rows_; ++i) {
      if (sgn(entering_[i]) <= 0) continue;
      t_ = inverse_[i][rows_] / entering_[i];
      const int c = leaving == rows_ ? -1 : cmp(t_, sum_);
      if (c < 0 || (c == 0 && basis_[i] < basis_[leaving])) {
        leaving = i;
        sum_ = t_;
      }
    }
    for (mpq_class& v : inverse_[leaving]) v /= entering_[leaving];
    for (std::size_t i = 0; i < rows_; ++i) {
      if (i == leaving || sgn(entering_[i]) == 0) continue;
      for (std::size_t j = 0; j <= rows_; ++j) {
        t_ = entering_[i] * inverse_[leaving][j];
        inverse_[i][j] -= t_;
      }
    }
    basis_[leaving] = q;
  }

  const LocalPoints& points_;
  const std::vector<std::uint32_t>& others_;
  const Control& control_;
  const std::uint32_t point_;
  const std::size_t rows_;
  RationalRows inverse_;
  std::vector<mpq_class> column_, entering_, prices_;
  std::vector<std::size_t> basis_;
  std::vector<double> rounded_;
  double rounded_size_ = 0;
  mpq_class t_, sum_;
};

}  // namespace

bool inside_exact(const LocalPoints& points, std::uint32_t point,
                  const std::vector<std::uint32_t>& others, const Control& control) {
  return Simplex(points, point, others, control).feasible();
}

}  // namespace cullhull::internal
