// Maximises r subject to a_i . x + r <= -b_i, |x_j| <= box and r <= box, by the dual simplex
// method. A basis is d + 1 constraints that hold with equality at z = (x, r); the most violated of
// the others enters, and the one whose multiplier would first become negative leaves.
#include "query/inscribed_ball.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace cullhull::internal {
namespace {

class DualSimplex {
 public:
  DualSimplex(const std::vector<double>& rows, unsigned d, double box)
      : rows_(rows), d_(d), n_(d + 1), count_(rows.size() / (d + 1)), box_(box) {
    // Starts at the far corner of the box; all multipliers but that of r <= box are 0.
    for (unsigned j = 0; j < n_; ++j) basis_.push_back(count_ + 2 * j);
    inverse_.assign(std::size_t{n_} * n_, 0);
    y_.assign(n_, 0);
    y_[d_] = 1;
  }

  Ball run(const Control& control) {
    constexpr unsigned patience = 50;  // stuck steps before Bland's slower rule; untested
    unsigned stuck = 0;
    double before = std::numeric_limits<double>::infinity();
    for (unsigned step = 0; step < 100000 && invert(); ++step) {
      if (step % 64 == 0) control.check();
      solve();
      stuck = z_[d_] < before ? 0 : stuck + 1;
      before = std::min(before, z_[d_]);
      const std::size_t entering = violated(stuck > patience);
      if (entering == none || !exchange(entering)) break;
    }
    return {{z_.begin(), z_.begin() + d_}, z_[d_]};
  }

 private:
  static constexpr std::size_t none = ~std::size_t{0};

  /// Coefficients and right-hand side of constraint i: the rows, then x_j <= box and -x_j <= box
  /// (and r likewise, whose lower bound never binds).
  double constraint(std::size_t i, double* g) const {
    if (i < count_) {
      const double* row = rows_.data() + i * n_;
      std::copy(row, row + d_, g);
      g[d_] = 1;
      return -row[d_];
    }
    std::fill(g, g + n_, 0.0);
    g[(i - count_) / 2] = (i - count_) % 2 ? -1 : 1;
    return box_;
  }

  /// inverse_ = (basis rows)^-1, by Gauss-Jordan with pivoting; false where it is singular.
  bool invert() {
    const unsigned n = n_;
    std::vector<double> m(std::size_t{n} * 2 * n, 0);
    for (unsigned i = 0; i < n; ++i) {
      constraint(basis_[i], m.data() + std::size_t{i} * 2 * n);
      m[std::size_t{i} * 2 * n + n + i] = 1;
    }
    for (unsigned c = 0; c < n; ++c) {
      unsigned pivot = c;
      for (unsigned i = c; i < n; ++i)
        if (std::fabs(m[std::size_t{i} * 2 * n + c]) > std::fabs(m[std::size_t{pivot} * 2 * n + c]))
          pivot = i;
      const double p = m[std::size_t{pivot} * 2 * n + c];
      if (std::fabs(p) < 1e-14) return false;
      for (unsigned k = 0; k < 2 * n; ++k) {
        std::swap(m[std::size_t{pivot} * 2 * n + k], m[std::size_t{c} * 2 * n + k]);
        m[std::size_t{c} * 2 * n + k] /= p;
      }
      for (unsigned i = 0; i < n; ++i) {
        const double factor = m[std::size_t{i} * 2 * n + c];
        if (i == c || factor == 0) continue;
        for (unsigned k = 0; k < 2 * n; ++k)
          m[std::size_t{i} * 2 * n + k] -= factor * m[std::size_t{c} * 2 * n + k];
      }
    }
    for (unsigned i = 0; i < n; ++i)
      std::copy_n(m.data() + std::size_t{i} * 2 * n + n, n, inverse_.data() + std::size_t{i} * n);
    return true;
  }

  /// z where the basis holds with equality.
  void solve() {
    std::vector<double> g(n_), h(n_);
    for (unsigned i = 0; i < n_; ++i) h[i] = constraint(basis_[i], g.data());
    z_.assign(n_, 0);
    for (unsigned i = 0; i < n_; ++i)
      for (unsigned k = 0; k < n_; ++k) z_[i] += inverse_[std::size_t{i} * n_ + k] * h[k];
  }

  /// The most violated constraint, or the first one, which cannot cycle (Bland 1977).
  std::size_t violated(bool first) const {
    double size = 1;
    for (const double v : z_) size = std::max(size, std::fabs(v));
    double most = 1e-13 * size;
    std::size_t found = none;
    for (std::size_t i = 0; i < count_; ++i) {
      const double* row = rows_.data() + i * n_;
      double excess = z_[d_] + row[d_];
      for (unsigned j = 0; j < d_; ++j) excess += row[j] * z_[j];
      if (!(excess > most)) continue;
      found = i;
      if (first) return found;
      most = excess;
    }
    for (unsigned j = 0; j < d_; ++j)
      if (std::fabs(z_[j]) - box_ > most) {
        most = std::fabs(z_[j]) - box_;
        found = count_ + 2 * j + (z_[j] < 0);
      }
    return found;
  }

  /// False where no multiplier limits the step: the constraints contradict each other.
  bool exchange(std::size_t entering) {
    std::vector<double> g(n_), w(n_, 0);
    constraint(entering, g.data());
    for (unsigned k = 0; k < n_; ++k)
      for (unsigned i = 0; i < n_; ++i) w[k] += g[i] * inverse_[std::size_t{i} * n_ + k];
    unsigned leaving = n_;
    double step = std::numeric_limits<double>::infinity();
    for (unsigned k = 0; k < n_; ++k) {
      if (!(w[k] > 1e-12)) continue;
      const double at = std::max(y_[k], 0.0) / w[k];
      if (at < step || (at == step && basis_[k] < basis_[leaving])) {
        step = at;
        leaving = k;
      }
    }
    if (leaving == n_) {
      z_[d_] = -1;
      return false;
    }
    for (unsigned k = 0; k < n_; ++k) y_[k] -= step * w[k];
    y_[leaving] = step;
    basis_[leaving] = entering;
    return true;
  }

  const std::vector<double>& rows_;
  unsigned d_, n_;
  std::size_t count_;
  double box_;
  std::vector<std::size_t> basis_;
  std::vector<double> inverse_, y_, z_;
};

}  // namespace

Ball inscribed_ball(const std::vector<double>& rows, unsigned d, const Control& control) {
  Ball ball;
  // Planes are at most 1 from the origin, but nearly parallel ones may meet far away.
  for (double box = 4; box < 1e13; box *= 1000) {
    ball = DualSimplex(rows, d, box).run(control);
    if (ball.radius > 0) break;
  }
  return ball;
}

}  // namespace cullhull::internal
