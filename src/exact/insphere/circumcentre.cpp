#include "exact/insphere/circumcentre.hpp"

#include <cmath>
#include <vector>

#include "exact/insphere/circumcentres.hpp"
#include "exact/numbers/bounded.hpp"
#include "exact/numbers/rationals.hpp"
#include "exact/orientation/orientation.hpp"

namespace cullhull::internal {
namespace {

/// The corners of one cell for circumcentres.hpp.
struct PackedCell {
  PackedCell(unsigned k, bool weighted, const double* const* p) {
    const unsigned width = k + (weighted ? 1 : 0);
    for (unsigned i = 0; i <= k; ++i)
      for (unsigned j = 0; j < width; ++j) corners[(i * width + j) * centres_block] = p[i][j];
  }
  double corners[7 * 7 * centres_block] = {};
};

// Ziv's test. Let v be the double-double and e its error. If v - e and v + e round to the same
// double, so does the exact number between them. Example: v = 0.3 + 1e-25 and e = 1e-28: the next
// double is 5.6e-17 away and the middle between the two 2.8e-17, so 0.3 is right. Rational numbers
// are needed only if the middle of two doubles is within e of v.

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
  bool known = d == k && k <= 6;
  if (known) {
    double centre[6 * centres_block];
    centres_double_double(k, weighted, PackedCell(k, weighted, p).corners, 1, centre);
    for (unsigned j = 0; j < k; ++j) {
      out[j] = centre[j * centres_block];
      known = known && !std::isnan(out[j]);
    }
  }
  if (known) return;
  const std::vector<mpq_class> y = exact_offset(d, k, weighted, p);
  for (unsigned j = 0; j < d; ++j) out[j] = nearest_double(mpq_class(p[0][j]) + y[j]);
}

bool radius_at_most(unsigned d, unsigned k, const double* const* p, double radius) {
  return radius_above(d, k, p) <= radius;
}

double radius_above(unsigned d, unsigned k, const double* const* p) {
  double radii[centres_block] = {NAN}, radius = 0;
  if (d == k && k <= 6) radii_double_double(k, PackedCell(k, false, p).corners, 1, radii);
  if (!std::isnan(radii[0])) return radii[0];
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
