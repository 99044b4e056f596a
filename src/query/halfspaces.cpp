#include "cullhull/halfspaces.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "cullhull/error.hpp"
#include "geometry/gather.hpp"
#include "parallel/threads/parallel.hpp"
#include "parallel/threads/run.hpp"

namespace cullhull::internal {
namespace {

/// A largest ball inside halfspaces.
struct Ball {
  std::vector<double> centre;
  double radius = 0;  ///< not positive: doubles found no point inside
};

/// Maximises r subject to a_i . x + r <= -b_i, |x_j| <= box and r <= box, by the dual simplex
/// method. A basis is d + 1 constraints that hold with equality at z = (x, r); the most violated of
/// the others enters, and the one whose multiplier would first become negative leaves.
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

/// `rows`: count x (d + 1), |a| = 1 and a . x + b <= 0 inside, b of magnitude at most 1 (or 0).
/// Radii are capped, so an unbounded intersection has an answer too. Rounding affects the answer's
/// quality only: the caller checks it.
Ball inscribed_ball(const std::vector<double>& rows, unsigned d, const Control& control) {
  Ball ball;
  // Planes are at most 1 from the origin, but nearly parallel ones may meet far away.
  for (double box = 4; box < 1e13; box *= 1000) {
    ball = DualSimplex(rows, d, box).run(control);
    if (ball.radius > 0) break;
  }
  return ball;
}

/// Scales rows to |a| = 1, then the offsets to a largest magnitude of 1; `unit` receives that
/// scale.
std::vector<double> normalised(const std::vector<double>& rows, unsigned d, double& unit) {
  const std::size_t width = std::size_t{d} + 1;
  std::vector<double> out(rows);
  unit = 0;
  for (std::size_t i = 0; i < rows.size(); i += width) {
    double largest = 0, square = 0;
    for (unsigned j = 0; j < d; ++j) largest = std::max(largest, std::fabs(rows[i + j]));
    if (largest == 0)
      throw Error(ErrorCode::invalid_argument, "halfspace ", i / width, " has no normal: a is 0");
    for (unsigned j = 0; j < d; ++j) square += (rows[i + j] / largest) * (rows[i + j] / largest);
    const double length = std::sqrt(square);
    for (unsigned j = 0; j < width; ++j) out[i + j] = rows[i + j] / largest / length;
    unit = std::max(unit, std::fabs(out[i + d]));
  }
  if (unit == 0 || !std::isfinite(unit)) unit = 1;
  for (std::size_t i = d; i < out.size(); i += width) out[i] /= unit;
  return out;
}

std::vector<double> find_interior(const std::vector<double>& rows, unsigned d,
                                  const Control& control) {
  double unit = 1;
  const std::vector<double> unit_rows = normalised(rows, d, unit);
  Ball ball = inscribed_ball(unit_rows, d, control);
  if (!(ball.radius > 0))
    throw Error(ErrorCode::invalid_argument,
                "the halfspaces have no interior point in common (or one too thin for doubles to "
                "find; then give one)");
  for (double& v : ball.centre) v *= unit;
  return ball.centre;
}

/// The dual points. a . x + b is summed with a rounding error bound: a point x nearer to a plane
/// than that is refused, as the dual point would have no correct digit.
std::vector<double> dualise(const std::vector<double>& rows, unsigned d, const double* x) {
  const std::size_t width = std::size_t{d} + 1;
  std::vector<double> out;
  out.reserve(rows.size() / width * d);
  for (std::size_t i = 0; i < rows.size(); i += width) {
    double sum = rows[i + d], size = std::fabs(rows[i + d]);
    for (unsigned j = 0; j < d; ++j) {
      sum += rows[i + j] * x[j];
      size += std::fabs(rows[i + j] * x[j]);
    }
    if (!(sum < -1.01 * static_cast<double>(d + 1) * 0x1p-53 * size - 0x1p-1060))
      throw Error(ErrorCode::invalid_argument,
                  "the interior point is not strictly inside halfspace ", i / width);
    for (unsigned j = 0; j < d; ++j) {
      out.push_back(rows[i + j] / -sum);
      if (!std::isfinite(out.back()))
        throw Error(ErrorCode::invalid_argument, "the interior point is too near halfspace ",
                    i / width, ": its dual point overflows");
    }
  }
  return out;
}

/// Writes x0 - n / o for every dual facet n . y + o = 0 that the origin is strictly below, else
/// NaN.
void write_vertices(HalfspaceIntersection& h) {
  const unsigned d = h.dimension;
  const std::size_t width = std::size_t{d} + 1;
  h.bounded = h.dual.affine_dimension == static_cast<int>(d);
  if (!h.bounded) {  // the dual is flat: no facet of it is a vertex
    h.vertices.assign(h.dual.facet_count() * d, std::numeric_limits<double>::quiet_NaN());
    return;
  }
  for (std::size_t f = 0; f < h.dual.facet_count(); ++f) {
    const double* plane = h.dual.facet_planes.data() + f * width;
    const bool below = plane[d] < 0;
    h.bounded = h.bounded && below;
    for (unsigned j = 0; j < d; ++j)
      h.vertices.push_back(below ? h.interior_point[j] - plane[j] / plane[d]
                                 : std::numeric_limits<double>::quiet_NaN());
  }
}

}  // namespace
}  // namespace cullhull::internal

namespace cullhull {

using namespace internal;

HalfspaceIntersection intersect_halfspaces(const PointView& halfspaces,
                                           const double* interior_point, const Options& options) {
  if (halfspaces.dimension < 2)
    throw Error(ErrorCode::invalid_argument,
                "a halfspace is a row of d coefficients and an offset");
  require_points(halfspaces);
  HalfspaceIntersection h;
  const unsigned d = halfspaces.dimension - 1;
  h.dimension = d;
  const Run run(options);
  const Array<double> gathered = gather_points(halfspaces, nullptr, halfspaces.count, run);
  const std::vector<double> rows(gathered.begin(), gathered.end());
  if (interior_point != nullptr) {
    h.interior_point.assign(interior_point, interior_point + d);
    for (const double v : h.interior_point)
      if (!std::isfinite(v))
        throw Error(ErrorCode::not_finite,
                    "the interior point has a coordinate that is not finite");
  } else {
    h.interior_point = find_interior(rows, d, run.control);
  }
  h.dual_points = dualise(rows, d, h.interior_point.data());
  h.dual = convex_hull(PointView::row_major(h.dual_points.data(), halfspaces.count, d), options);
  write_vertices(h);
  return h;
}

}  // namespace cullhull
