#include "exact/insphere/circumcentre.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "exact/determinants/minors.hpp"
#include "exact/insphere/lift_filter.hpp"
#include "exact/numbers/bounded.hpp"
#include "exact/numbers/double_double.hpp"
#include "exact/numbers/rationals.hpp"
#include "exact/orientation/orientation.hpp"
#include "parallel/dispatch.hpp"

namespace cullhull::internal {
namespace {

/// Returns a / b within 16 u^2, u = 2^-53, barring overflow and underflow; faster than operator/,
/// whose last correction it omits. The remainder of the first step is at most 2.1 u |a|, known
/// within 8 u^2 |a|; the quotient of its leading part and that of b has three roundings: 6.3 u^2 of
/// the result.
DoubleDouble quotient(DoubleDouble a, DoubleDouble b) {
  const double q = a.high / b.high;
  return DoubleDouble::sum(q, (a - b * DoubleDouble(q)).high / b.high);
}

/// The centre minus p_0; coordinate j is within error[j] of exact.
template <unsigned K>
struct Offset {
  DoubleDouble value[K];
  double error[K];
};

/// Computes the offset by Cramer's rule over the edges e_i = p_i - p_0 and their lifts |e_i|^2 -
/// (w_i - w_0): coordinate j is a quotient of minors. Every operation of double-doubles errs by
/// less than 2^-101, so a minor is within roundings x 2^-101 x k! x the product of its columns'
/// largest magnitudes; the quotient's error follows. Returns false if that proves nothing.
template <unsigned K>
bool offset_by_double_doubles(bool weighted, const double* const* p, Offset<K>& out) {
  DoubleDouble m[K][K + 1];
  double largest[K + 1] = {};
  for (unsigned i = 0; i < K; ++i) {
    DoubleDouble lift;
    double size = 0;
    for (unsigned j = 0; j < K; ++j) {
      m[i][j] = DoubleDouble::sum(p[i + 1][j], -p[0][j]);
      largest[j] = std::max(largest[j], std::abs(m[i][j].high));
      const DoubleDouble square = m[i][j] * m[i][j];
      lift = lift + square;
      size += square.high;
    }
    if (weighted) {
      const DoubleDouble w = DoubleDouble::sum(p[i + 1][K], -p[0][K]);
      lift = lift - w;
      size += std::abs(w.high);
    }
    m[i][K] = lift;
    largest[K] = std::max(largest[K], size);
  }
  // Within these limits nothing overflows, and underflow adds up to less than 2^-300.
  double product = 1;
  for (unsigned j = 0; j < K; ++j) {
    if (!(largest[j] >= 0x1p-80 && largest[j] <= 0x1p80)) return false;
    product *= largest[j];
  }
  if (!(largest[K] <= 0x1p164)) return false;
  DoubleDouble det[1U << (K + 1)];
  expand_minors<K + 1, false>(m, K, det, static_cast<DoubleDouble*>(nullptr));
  constexpr unsigned all = (1U << (K + 1)) - 1;
  constexpr double error = (minor_roundings(K) + 3 * K + 12) * 0x1p-101 * factorial(K);
  const DoubleDouble whole = det[all ^ (1U << K)];
  const double whole_error = error * product + 0x1p-300;
  const double size = std::abs(whole.high);
  if (!(size > 0x1p20 * whole_error)) return false;
  for (unsigned j = 0; j < K; ++j) {
    const double minor_error = error * product / largest[j] * largest[K] + 0x1p-300;
    DoubleDouble y = quotient(det[all ^ (1U << j)], whole + whole);
    if ((K - 1 - j) % 2 == 1) y = -y;
    out.value[j] = y;
    // Twice the errors of both minors and of the division.
    out.error[j] =
        2 * (minor_error + std::abs(y.high) * 2 * whole_error) / size + 0x1p-96 * std::abs(y.high);
  }
  return true;
}

/// Computes the rounded centre. A coordinate is known if everything within its error rounds alike
/// (Ziv 1991).
template <unsigned K>
bool by_double_doubles(bool weighted, const double* const* p, double* out) {
  Offset<K> y;
  if (!offset_by_double_doubles<K>(weighted, p, y)) return false;
  for (unsigned j = 0; j < K; ++j) {
    const DoubleDouble x = y.value[j] + DoubleDouble(p[0][j]);
    const double doubt = y.error[j] + 0x1p-96 * (std::abs(y.value[j].high) + std::abs(p[0][j]));
    if (x.high + (x.low + doubt) != x.high + (x.low - doubt)) return false;
    out[j] = x.high + x.low;
  }
  return true;
}

/// Returns the sign of |offset|^2 - radius^2; zero if undecided.
template <unsigned K>
Sign compare_radius(const Offset<K>& y, double radius) {
  if (!(radius >= 0x1p-80 && radius <= 0x1p300)) return Sign::zero;
  DoubleDouble sum = -(DoubleDouble(radius) * DoubleDouble(radius));
  double doubt = 0x1p-96 * radius * radius;
  for (unsigned j = 0; j < K; ++j) {
    const double size = std::abs(y.value[j].high) + y.error[j];
    if (!(size <= 0x1p300)) return Sign::zero;
    sum = sum + y.value[j] * y.value[j];
    doubt += 4 * size * y.error[j] + 0x1p-96 * size * size;
  }
  doubt += 0x1p-300;
  return sum.high > 2 * doubt    ? Sign::positive
         : sum.high < -2 * doubt ? Sign::negative
                                 : Sign::zero;
}

template <unsigned K>
Sign radius_by_double_doubles(const double* const* p, double radius) {
  Offset<K> y;
  return offset_by_double_doubles<K>(false, p, y) ? compare_radius(y, radius) : Sign::zero;
}

/// Returns the least double that is at least the radius, starting from an estimate; 0 if undecided.
template <unsigned K>
double radius_above_by_double_doubles(const double* const* p) {
  Offset<K> y;
  if (!offset_by_double_doubles<K>(false, p, y)) return 0;
  double square = 0;
  for (unsigned j = 0; j < K; ++j) square += y.value[j].high * y.value[j].high;
  double radius = std::sqrt(square);
  for (Sign sign; (sign = compare_radius(y, radius)) != Sign::negative;) {
    if (sign == Sign::zero) return 0;
    radius = std::nextafter(radius, INFINITY);
  }
  for (Sign sign; (sign = compare_radius(y, std::nextafter(radius, 0))) != Sign::positive;) {
    if (sign == Sign::zero) return 0;
    radius = std::nextafter(radius, 0);
  }
  return radius;
}

mpq_class dot(const std::vector<mpq_class>& a, const std::vector<mpq_class>& b) {
  mpq_class sum = 0;
  for (std::size_t j = 0; j < a.size(); ++j) sum += a[j] * b[j];
  return sum;
}

std::vector<mpq_class> difference(unsigned d, const double* a, const double* b) {
  std::vector<mpq_class> r(d);
  for (unsigned j = 0; j < d; ++j) r[j] = mpq_class(a[j]) - mpq_class(b[j]);
  return r;
}

/// Solves (e_i . sum of s_j e_j) = right[i] for s; returns the sum of s_j e_j.
std::vector<mpq_class> in_span(const RationalRows& edges, const std::vector<mpq_class>& right) {
  const std::size_t k = edges.size();
  RationalRows m(k, std::vector<mpq_class>(k + 1));
  for (std::size_t i = 0; i < k; ++i) {
    for (std::size_t j = 0; j < k; ++j) m[i][j] = dot(edges[i], edges[j]);
    m[i][k] = right[i];
  }
  if (!solve(m)) flat_simplex();
  std::vector<mpq_class> sum(edges[0].size());
  for (std::size_t i = 0; i < k; ++i)
    for (std::size_t j = 0; j < sum.size(); ++j) sum[j] += m[i][k] * edges[i][j];
  return sum;
}

/// Returns the centre minus p_0.
std::vector<mpq_class> exact_offset(unsigned d, unsigned k, bool weighted, const double* const* p) {
  RationalRows edges;
  std::vector<mpq_class> right;
  for (unsigned i = 1; i <= k; ++i) {
    edges.push_back(difference(d, p[i], p[0]));
    mpq_class lift = dot(edges.back(), edges.back());
    if (weighted) lift -= mpq_class(p[i][d]) - mpq_class(p[0][d]);
    right.emplace_back(lift / 2);
  }
  return in_span(edges, right);
}

/// Scales by a power of two, then rounds.
void rounded_direction(const std::vector<mpq_class>& v, double* out) {
  mpq_class largest = 0;
  for (const mpq_class& x : v)
    if (abs(x) > largest) largest = abs(x);
  const auto bits = [](const mpz_class& z) {
    return static_cast<long>(mpz_sizeinbase(z.get_mpz_t(), 2));
  };
  long e = bits(largest.get_num()) - bits(largest.get_den());
  const auto scaled = [&](const mpq_class& x) {
    mpq_class q;
    if (e >= 0)
      mpq_div_2exp(q.get_mpq_t(), x.get_mpq_t(), static_cast<mp_bitcnt_t>(e));
    else
      mpq_mul_2exp(q.get_mpq_t(), x.get_mpq_t(), static_cast<mp_bitcnt_t>(-e));
    return q;
  };
  if (scaled(largest) > 1) ++e;
  for (std::size_t j = 0; j < v.size(); ++j) out[j] = nearest_double(scaled(v[j]));
}

}  // namespace

void circumcentre(unsigned d, unsigned k, bool weighted, const double* const* p, double* out) {
  const bool done = d == k && with_dimension<1, 6, 0>(k, [&](auto known) {
                      if constexpr (known() == 0)
                        return false;
                      else
                        return by_double_doubles<known()>(weighted, p, out);
                    });
  if (done) return;
  const std::vector<mpq_class> y = exact_offset(d, k, weighted, p);
  for (unsigned j = 0; j < d; ++j) out[j] = nearest_double(mpq_class(p[0][j]) + y[j]);
}

bool radius_at_most(unsigned d, unsigned k, const double* const* p, double radius) {
  if (d == k) {
    const Sign sign = with_dimension<1, 6, 0>(k, [&](auto known) {
      if constexpr (known() == 0)
        return Sign::zero;
      else
        return radius_by_double_doubles<known()>(p, radius);
    });
    if (sign != Sign::zero) return sign == Sign::negative;
  }
  const std::vector<mpq_class> y = exact_offset(d, k, false, p);
  return dot(y, y) <= mpq_class(radius) * mpq_class(radius);
}

double radius_above(unsigned d, unsigned k, const double* const* p) {
  double radius = 0;
  if (d == k)
    radius = with_dimension<1, 6, 0>(k, [&](auto known) {
      if constexpr (known() == 0)
        return 0.0;
      else
        return radius_above_by_double_doubles<known()>(p);
    });
  if (radius > 0) return radius;
  const std::vector<mpq_class> y = exact_offset(d, k, false, p);
  const mpq_class square = dot(y, y);
  const auto reaches = [&](double r) { return std::isinf(r) || mpq_class(r) * r >= square; };
  // An estimate from a square that is scaled by a power of four into the range of doubles.
  const long bits = static_cast<long>(mpz_sizeinbase(square.get_num().get_mpz_t(), 2)) -
                    static_cast<long>(mpz_sizeinbase(square.get_den().get_mpz_t(), 2));
  const long half = bits / 2;
  mpq_class scaled;
  if (half >= 0)
    mpq_div_2exp(scaled.get_mpq_t(), square.get_mpq_t(), static_cast<mp_bitcnt_t>(2 * half));
  else
    mpq_mul_2exp(scaled.get_mpq_t(), square.get_mpq_t(), static_cast<mp_bitcnt_t>(-2 * half));
  radius = std::ldexp(std::sqrt(scaled.get_d()), static_cast<int>(half));
  while (!reaches(radius)) radius = std::nextafter(radius, INFINITY);
  while (radius > 0 && reaches(std::nextafter(radius, 0))) radius = std::nextafter(radius, 0);
  return radius;
}

void outward_direction(unsigned d, unsigned k, const double* const* p, const double* opposite,
                       double* out) {
  if (d == k && d >= 2) {
    plane_exact(d, p, out);
    std::vector<const double*> all(p, p + d);
    all.push_back(opposite);
    if (orientation(d, all.data()) == Sign::positive)
      for (unsigned j = 0; j < d; ++j) out[j] = out[j] == 0 ? 0 : -out[j];
    return;
  }
  std::vector<mpq_class> away = difference(d, p[0], opposite);
  RationalRows edges;
  std::vector<mpq_class> right;
  for (unsigned i = 1; i < k; ++i) {
    edges.push_back(difference(d, p[i], p[0]));
    right.push_back(dot(edges.back(), away));
  }
  if (!edges.empty()) {
    const std::vector<mpq_class> along = in_span(edges, right);
    for (unsigned j = 0; j < d; ++j) away[j] -= along[j];
  }
  rounded_direction(away, out);
}

}  // namespace cullhull::internal
