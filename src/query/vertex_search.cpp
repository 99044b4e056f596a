#include "query/vertex_search.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "exact/numbers/exact_float.hpp"

namespace cullhull::internal {
namespace {

/// The power of two that scales `largest` to about 1; 1 for zero.
double power_for(double largest, int& exponent) {
  exponent = 0;
  if (largest == 0) return 1;
  std::frexp(largest, &exponent);
  return std::ldexp(1.0, std::min(-exponent, 1023));
}

}  // namespace

VertexSearch::VertexSearch(const QueryPoints& points, const Control& control) : points_(&points) {
  const unsigned d = points.dimension;
  factor_.resize(d);
  for (unsigned j = 0; j < d; ++j) {
    int exponent = 0;
    factor_[j] = power_for(std::max(std::fabs(points.low[j]), std::fabs(points.high[j])), exponent);
  }
  scaled_.resize(points.full.size());
  for (std::size_t i = 0; i < scaled_.size(); ++i) scaled_[i] = points.full[i] * factor_[i % d];
  if (points.k < 2) return;  // at most two vertices
  join_neighbours(control);
  cube_ = DirectionCube(d, std::min(0x1p16, static_cast<double>(points.count())));
  if (cube_.empty() || d > 6) return;
  hints_ =
      cube_.answers(control, [&](std::uint32_t last, const double* u) { return climb(last, u); });
}

void VertexSearch::join_neighbours(const Control& control) {
  const unsigned k = points_->k;
  const std::vector<std::uint32_t>& corners = points_->corners;
  neighbours_ = Adjacency<std::uint32_t, std::uint32_t>(points_->count(), [&](const auto& add) {
    for (std::size_t s = 0; s < corners.size(); s += k) {
      if (s / k % 8192 == 0) control.check();
      for (unsigned i = 0; i < k; ++i)
        for (unsigned j = 0; j < k; ++j)
          if (i != j) add(corners[s + i], corners[s + j]);
    }
  });
  neighbours_.sort_and_unique([&] { control.check(); });
}

double VertexSearch::product(std::uint32_t v, const double* u) const {
  const unsigned d = points_->dimension;
  const double* p = scaled_.data() + std::size_t{v} * d;
  double sum = 0;
  for (unsigned j = 0; j < d; ++j) sum += p[j] * u[j];
  return sum;
}

std::uint32_t VertexSearch::climb(std::uint32_t v, const double* u) const {
  double best = product(v, u);
  for (;;) {
    std::uint32_t next = v;
    for (const std::uint32_t w : neighbours_[v]) {
      const double p = product(w, u);
      if (p > best) {
        best = p;
        next = w;
      }
    }
    if (next == v) return v;
    v = next;
  }
}

int VertexSearch::compare(std::uint32_t a, std::uint32_t b, const double* direction) const {
  const unsigned d = points_->dimension;
  const double* p = points_->full.data() + std::size_t{a} * d;
  const double* q = points_->full.data() + std::size_t{b} * d;
  ExactFloat sum;
  for (unsigned j = 0; j < d; ++j)
    sum = sum + (ExactFloat(p[j]) - ExactFloat(q[j])) * ExactFloat(direction[j]);
  return sum > ExactFloat() ? 1 : sum.zero() ? 0 : -1;
}

std::uint32_t VertexSearch::support(const double* direction) const {
  const unsigned d = points_->dimension;
  std::vector<double> u(d);
  // Converts the direction to scaled coordinates, then by a power of two to a largest component
  // near 1.
  int top = std::numeric_limits<int>::min();
  for (unsigned j = 0; j < d; ++j) {
    if (direction[j] == 0) continue;
    int e = 0, f = 0;
    std::frexp(direction[j], &e);
    std::frexp(factor_[j], &f);
    top = std::max(top, e - f);
  }
  if (top == std::numeric_limits<int>::min()) return 0;
  double size = 0;
  for (unsigned j = 0; j < d; ++j) {
    int e = 0, f = 0;
    const double m = std::frexp(direction[j], &e);
    std::frexp(factor_[j], &f);
    u[j] = std::ldexp(m, std::max(e - f + 1 - top, -2000));
    size += std::fabs(u[j]);
  }
  // Scaled coordinates are at most 1: the error of d products and d - 1 sums, and underflow.
  const double error = 1.01 * (d + 1) * 0x1p-53 * size + 0x1p-1000;
  std::vector<std::uint32_t> rivals;
  if (points_->k < 2) {
    rivals.resize(points_->count());
    std::iota(rivals.begin(), rivals.end(), 0U);
  } else {
    const std::uint32_t v = climb(hints_.empty() ? 0 : hints_[cube_.cell(u.data())], u.data());
    const double floor = product(v, u.data()) - 2 * error;
    rivals = {v};
    for (std::size_t i = 0; i < rivals.size(); ++i)
      for (const std::uint32_t w : neighbours_[rivals[i]]) {
        if (product(w, u.data()) < floor) continue;
        if (std::find(rivals.begin(), rivals.end(), w) == rivals.end()) rivals.push_back(w);
      }
  }
  std::uint32_t best = rivals[0];
  for (std::size_t i = 1; i < rivals.size(); ++i) {
    const int sign = compare(rivals[i], best, direction);
    if (sign > 0 || (sign == 0 && rivals[i] < best)) best = rivals[i];
  }
  return best;
}

// --------------------------------------------------------------------------------- nearest point

namespace {

/// Corners of a simplex relative to the query point, and the weights of its nearest point.
struct Corral {
  unsigned d;
  std::vector<std::uint32_t> ids;
  std::vector<double> rows, weights;

  std::size_t size() const { return ids.size(); }
  void add(std::uint32_t id, const double* p) {
    ids.push_back(id);
    rows.insert(rows.end(), p, p + d);
    weights.push_back(0);
  }
  void remove(std::size_t i) {
    const auto at = static_cast<std::ptrdiff_t>(i), width = static_cast<std::ptrdiff_t>(d);
    ids.erase(ids.begin() + at);
    weights.erase(weights.begin() + at);
    rows.erase(rows.begin() + at * width, rows.begin() + (at + 1) * width);
  }

  /// Weights of the point of the corners' flat nearest to the origin, by Gram-Schmidt (twice) on
  /// the edges. False if the corners are dependent up to rounding.
  bool nearest_in_flat(std::vector<double>& w) const {
    const std::size_t n = size() - 1;
    std::vector<double> q(n * d), r(n * n, 0.0), c(n);
    std::vector<double> rest(rows.begin(), rows.begin() + d);  // -(0 - first corner)
    for (std::size_t i = 0; i < n; ++i) {
      double* v = q.data() + i * d;
      double before = 0;
      for (unsigned j = 0; j < d; ++j) {
        v[j] = rows[(i + 1) * d + j] - rows[j];
        before += v[j] * v[j];
      }
      for (int pass = 0; pass < 2; ++pass)
        for (std::size_t b = 0; b < i; ++b) {
          double dot = 0;
          for (unsigned j = 0; j < d; ++j) dot += v[j] * q[b * d + j];
          for (unsigned j = 0; j < d; ++j) v[j] -= dot * q[b * d + j];
          r[b * n + i] += dot;
        }
      double after = 0;
      for (unsigned j = 0; j < d; ++j) after += v[j] * v[j];
      if (!(after > 0x1p-90 * before)) return false;
      const double length = std::sqrt(after);
      r[i * n + i] = length;
      double dot = 0;
      for (unsigned j = 0; j < d; ++j) {
        v[j] /= length;
        dot += rest[j] * v[j];
      }
      for (unsigned j = 0; j < d; ++j) rest[j] -= dot * v[j];
      c[i] = -dot;
    }
    w.assign(n + 1, 0);
    double sum = 0;
    for (std::size_t i = n; i-- > 0;) {
      double v = c[i];
      for (std::size_t j = i + 1; j < n; ++j) v -= r[i * n + j] * w[j + 1];
      w[i + 1] = v / r[i * n + i];
      sum += w[i + 1];
    }
    w[0] = 1 - sum;
    return true;
  }

  void point(double* x) const {
    std::fill(x, x + d, 0.0);
    for (std::size_t i = 0; i < size(); ++i)
      for (unsigned j = 0; j < d; ++j) x[j] += weights[i] * rows[i * d + j];
  }
};

/// Moves the weights to the nearest point of the corners' hull, dropping corners with no weight.
void settle(Corral& corral) {
  std::vector<double> w;
  for (;;) {
    if (!corral.nearest_in_flat(w)) {
      corral.remove(corral.size() - 1);  // the newest depends on the others
      continue;
    }
    double step = 1;
    std::size_t leaving = w.size();
    for (std::size_t i = 0; i < w.size(); ++i)
      if (w[i] <= 0) {
        const double at = corral.weights[i] / std::max(corral.weights[i] - w[i], 0x1p-1000);
        if (leaving == w.size() || at < step) {
          step = std::min(at, 1.0);
          leaving = i;
        }
      }
    for (std::size_t i = 0; i < w.size(); ++i)
      corral.weights[i] += step * (w[i] - corral.weights[i]);
    if (leaving == w.size()) return;
    corral.remove(leaving);
  }
}

}  // namespace

VertexSearch::Nearest VertexSearch::nearest(const double* q) const {
  const unsigned d = points_->dimension;
  double largest = 0;
  for (unsigned j = 0; j < d; ++j)
    largest = std::max(
        {largest, std::fabs(points_->low[j]), std::fabs(points_->high[j]), std::fabs(q[j])});
  int exponent = 0;
  const double unit = power_for(largest, exponent) / 4;  // keeps differences below 1
  const auto row = [&](std::uint32_t v, double* p) {
    for (unsigned j = 0; j < d; ++j)
      p[j] = points_->full[std::size_t{v} * d + j] * unit - q[j] * unit;
  };
  std::vector<double> p(d), x(d), u(d);
  Corral corral{d, {}, {}, {}};
  row(0, p.data());
  corral.add(0, p.data());
  corral.weights[0] = 1;
  double square = std::numeric_limits<double>::infinity();
  std::uint32_t at = 0;
  // Norms decrease in every round, so no corral is repeated; the limit is for rounding alone.
  for (int round = 0; round < 1000; ++round) {
    corral.point(x.data());
    double now = 0;
    for (const double v : x) now += v * v;
    if (!(now < square)) break;
    square = now;
    // The direction opposite to x, in the units of the scaled coordinates.
    for (unsigned j = 0; j < d; ++j) u[j] = -x[j] * (unit / factor_[j]);
    if (points_->k >= 2) {
      at = climb(at, u.data());
    } else {
      for (std::uint32_t v = 0; v < points_->count(); ++v)
        if (product(v, u.data()) > product(at, u.data())) at = v;
    }
    if (std::find(corral.ids.begin(), corral.ids.end(), at) != corral.ids.end()) break;
    row(at, p.data());
    double dot = 0;
    for (unsigned j = 0; j < d; ++j) dot += x[j] * p[j];
    if (!(dot < square)) break;
    corral.add(at, p.data());
    settle(corral);
  }
  Nearest out;
  corral.point(x.data());
  double length = 0;
  for (const double v : x) length = std::hypot(length, v);
  out.distance = std::ldexp(length * 4, -std::min(-exponent, 1023));
  out.corners = corral.ids;
  return out;
}

}  // namespace cullhull::internal
