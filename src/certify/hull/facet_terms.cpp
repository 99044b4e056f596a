// The check computes normals by cofactors in doubles, in double-doubles below lambda = 2^-12 (in
// flats and from nine dimensions on by Gram-Schmidt with each projection done twice), and below
// 2^-40 in b bits without a bound on exponents. Cofactors (k = d <= 8) then are off by 2^(16-b)
// P_c, of the unit normal by 2^(16-b) p_c / lambda; b is doubled until lambda >= 2^(80-b), which
// leaves 2^-11 of u p_c. For k = d > 8 cofactors are integers by elimination (`exact_plane.*`),
// each rounded once to 256 bits. Gram-Schmidt in flats: with lambda >= 2^(-b/8) half of the bits
// are right, and where axes differ as much as above b begins at 8192, so that what is lost is below
// the least double. At the latest b makes a zero certain: what is left of an edge is a quotient of
// Gram minors. Where all numbers are within 2^232 of each other, cofactors up to 8D are integers by
// elimination as well: a tenth of the time. Sums of volumes and areas whose bounds exceed rho of
// them (beyond eight dimensions 2^-38) are computed again from such terms, all positive.
// `tests/exactness/certify_mutations_test.cpp` compares with rational arithmetic.

#include "certify/hull/facet_terms.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "exact/determinants/cofactors.hpp"
#include "exact/determinants/minors.hpp"
#include "exact/numbers/double_double.hpp"
#include "exact/numbers/double_parts.hpp"
#include "exact/planes/exact_plane.hpp"
#include "parallel/dispatch.hpp"

namespace cullhull::internal::certify {
namespace {

/// The greatest ratio of a measure in the flat to that of its projection where the library computes
/// in doubles (make_frame).
constexpr double flat_stretch = 0x1p8;

double length(const double* v, unsigned n) {
  double square = 0;
  for (unsigned c = 0; c < n; ++c) square += v[c] * v[c];
  return std::sqrt(square);
}

double power(double base, double exponent) { return std::pow(base, exponent); }

/// Number type of `Orthogonal`: double-doubles.
struct DoubleDoubles {
  using Real = DoubleDouble;
  Real zero() const { return 0; }
  Real difference(double a, double b) const { return DoubleDouble::sum(a, -b); }
  Real root(const Real& v) const {
    if (!(v.high > 0)) return 0;
    const double x = std::sqrt(v.high);
    return DoubleDouble(x) + (v - DoubleDouble::product(x, x)) / DoubleDouble(2 * x);
  }
  bool positive(const Real& v) const { return v.high > 0; }
  bool less(const Real& a, const Real& b) const { return (a - b).high < 0; }
  static double rounded(const Real& v) { return v.value(); }
};

struct WideFloats {
  using Real = mpf_class;
  mp_bitcnt_t bits;
  Real zero() const { return Real(0, bits); }
  Real difference(double a, double b) const { return Real(a, bits) - Real(b, bits); }
  Real root(const Real& v) const { return sqrt(v); }
  bool positive(const Real& v) const { return v > 0; }
  bool less(const Real& a, const Real& b) const { return a < b; }
  static double rounded(const Real& v) { return v.get_d(); }
};

/// Gram-Schmidt on the edges of a simplex from its first vertex; each edge is orthogonalised twice
/// against those before it. Its remainder is the part orthogonal to these. A further vertex (the
/// apex) is treated likewise; its remainder points inward.
template <class Arithmetic>
class Orthogonal {
 public:
  using Real = typename Arithmetic::Real;
  Orthogonal(const Arithmetic& a, unsigned d) : a_(a), d_(d), lengths(a.zero()), measure(a.zero()) {
    lengths = lengths + Real(1);
    measure = measure + Real(1);
  }

  /// False if the remainder is zero.
  bool add_edge(const double* from, const double* to) {
    std::vector<Real> row = edge(from, to);
    const Real whole = norm(row);
    if (a_.positive(whole))
      for (const Real& v : row) unit_edges.push_back(Arithmetic::rounded(Real(v / whole)));
    const Real rest = free(row);
    lengths = lengths * whole;
    measure = measure * rest;
    if (!a_.positive(rest)) return false;
    for (Real& v : row) v = v / rest;
    rows_.push_back(std::move(row));
    return true;
  }

  /// Keeps the offered vertex whose remainder is longest relative to its distance.
  void offer_apex(const double* from, const double* to) {
    std::vector<Real> row = edge(from, to);
    const Real whole = norm(row);
    if (!a_.positive(whole)) return;
    const Real rest = free(row);
    const Real ratio = rest / whole;
    if (!outward.empty() && !a_.less(upright, ratio)) return;
    if (!a_.positive(rest)) return;
    upright = ratio;
    outward = std::move(row);
    for (Real& v : outward) v = -v / rest;
  }

 private:
  const Arithmetic a_;
  const unsigned d_;

 public:
  /// Rows orthogonalised twice are orthogonal up to the last bits. The share of an edge is its
  /// remainder's length over its own. The remainder's error is that of the edge's last bits times
  /// the reciprocals of the shares before it: altogether 2^-bits / share^2. If the
  /// product of all shares is above 2^-(bits / 8), more than half of the bits are right.
  bool trusted(mp_bitcnt_t bits) const {
    if (outward.empty()) return false;
    Real least = lengths * Real(1);
    mpf_div_2exp(least.get_mpf_t(), least.get_mpf_t(), bits / 8);
    Real steep(1, 64);
    mpf_div_2exp(steep.get_mpf_t(), steep.get_mpf_t(), bits / 8);
    return measure > least && upright > steep;
  }

  /// Sets `height` to that of the plane over `origin`. False if the precision may not suffice.
  bool find_height(const double* from, const double* origin, mp_bitcnt_t bits, Real& height) const {
    Real square = a_.zero();
    for (unsigned c = 0; c < d_; ++c) {
      const Real step = a_.difference(from[c], origin[c]);
      height += outward[c] * step;
      square += step * step;
    }
    Real least = a_.root(square);
    mpf_div_2exp(least.get_mpf_t(), least.get_mpf_t(), bits / 4);
    return height > least;
  }

  Real lengths, measure, upright = Real(0);
  std::vector<Real> outward;       ///< the unit normal, outward
  std::vector<double> unit_edges;  ///< rows, edges of length 1

 private:
  std::vector<Real> edge(const double* from, const double* to) const {
    std::vector<Real> row;
    for (unsigned c = 0; c < d_; ++c) row.push_back(a_.difference(to[c], from[c]));
    return row;
  }
  Real norm(const std::vector<Real>& row) const {
    Real square = a_.zero();
    for (const Real& v : row) square = square + v * v;
    return a_.root(square);
  }
  Real free(std::vector<Real>& row) const {
    for (unsigned twice = 0; twice < 2; ++twice)
      for (const std::vector<Real>& unit : rows_) {
        Real dot = a_.zero();
        for (unsigned c = 0; c < d_; ++c) dot = dot + unit[c] * row[c];
        for (unsigned c = 0; c < d_; ++c) row[c] = row[c] - dot * unit[c];
      }
    return norm(row);
  }

  std::vector<std::vector<Real>> rows_;
};

/// Products of shorter edges may underflow, and their scaling may have been inexact.
constexpr double least_edge = 0x1p-80;

}  // namespace

CheckedFacets::CheckedFacets(const Subject& s)
    : s_(s), d_(s.hull.dimension), k_(s.k), rows_(s.full.data()) {
  for (unsigned c = 0; c < d_; ++c)
    largest_ = std::max({largest_, std::fabs(s.low[c]), std::fabs(s.high[c])});
  if (largest_ > 0 && !(largest_ > 0x1p-20 && largest_ < 0x1p20)) {
    exponent_ = std::ilogb(largest_) + 1;
    scaled_.resize(s.full.size());
    for (std::size_t i = 0; i < scaled_.size(); ++i) scaled_[i] = std::ldexp(s.full[i], -exponent_);
    rows_ = scaled_.data();
  }
  for (unsigned c = 0; c < d_; ++c) {
    const double low = s.low[c], high = s.high[c];
    wild_ = wild_ || (low != high && !(high / 2 - low / 2 > std::ldexp(largest_, -399)));
  }
  if (k_ < d_) {
    for (unsigned c = 0; c < d_; ++c) constant_.push_back(s.low[c] == s.high[c]);
  }
  // docs/exactness.md, "Numbers": four times the error that the library's arithmetic may have.
  const double k = k_, terms = 4 * (minor_roundings(k_ > 1 ? k_ - 1 : 1) + 3);
  beta_ = 2 * d_ + 48;
  // Where random edges are far from orthogonal (k > 8), the library uses doubles down to smaller
  // shares.
  for (unsigned i = 1; k_ > 8 && i <= k_; ++i) usual_share_ *= std::sqrt(i / k);
  careful_share_ *= usual_share_;
  // Four times the check's own d + 4 roundings of a height, and more in the projection of a flat.
  loss_ = std::max((k_ == d_ ? 16 : 256) * k, 4.0 * (d_ + 4));
  // Why a volume is never off by more than rho: Sums in doubles count only where Sum u L max|w_c|
  // <= 2^-42 of the volume (docs/exactness.md, "Measures") over simplices with lambda >= 2^-12. A
  // share loses at most (N(r) + 3) u Lambda Sum p_c |w_c|, and Sum p_c <= k! k^{-(k - 1)/2}, as the
  // permanent of k rows of length 1 is at most k! k^{-k/2} (Carlen, Lieb, Loss 2006; the last row
  // is of k ones). So the sum loses at most 2^-30 (N(r) + 3) k! k^{-(k - 1)/2} of the volume, of
  // which rho is twice: 2^-25 in space, 2^-19 in 8D. Areas and sums in double-doubles, which count
  // with Lambda for L, lose less. Eliminations of k > 8 columns are done in doubles down to lambda
  // = 2^-12 sqrt (k! / k^k) and lose a quarter of alpha: rho = 2^-23 k sqrt (k^k / k!), at most
  // 1/4. docs/exactness.md, "Numbers": the greatest permanents of simplices computed in doubles.
  double spread = std::pow(k, -(k - 1) / 2);
  for (unsigned i = 2; i <= k_; ++i) spread *= i;
  relative_ = k_ <= 8 ? 0x1p-31 * terms * spread : std::min(0.25, 0x1p-36 * k / careful_share_);
  if (by_component()) {
    alpha_ = k_ == 1 ? 0 : terms;
  } else {
    alpha_ = k_ <= 8 ? terms * std::sqrt(k) * power(std::max(k - 1, 1.0), (k - 1) / 2)
                     : 0x1p8 * std::sqrt(k);
    if (k_ < d_) {
      alpha_ *= flat_stretch;
      beta_ *= flat_stretch;
    }
  }
  if (k_ > 8 && s.ids.size() == k_ + std::size_t{1})
    for (mp_bitcnt_t bits = wild_ ? 8192 : 512; !find_simplex_terms(bits);) bits *= 2;
}

double CheckedFacets::normal_bound(const FacetTerms& t, std::uint32_t simplex, unsigned c) const {
  const double underflow = wild_ ? 0x1p-1070 : 0x1p-500;
  const double share = std::max(t.share, careful_share_);
  if (by_component()) {
    const double own = std::fabs(t.normal[c]);
    if (k_ == 1) return unit * beta_ * own + underflow;
    return unit * (alpha_ * (t.spread[c] + own * t.spread_length) / share + beta_ * own) +
           underflow;
  }
  if (!constant_.empty() && constant_[c] != 0) return 0;
  if (wild_ && k_ < d_) return unit * beta_ * std::fabs(t.normal[c]) + underflow;
  if (k_ == d_) {  // orthogonal to an axis: no operation rounds
    for (unsigned a = 0; a < d_; ++a) {
      bool level = true;
      for (unsigned j = 1; j < k_ && level; ++j)
        level = s_.row(s_.simplex(simplex)[j])[a] == s_.row(s_.simplex(simplex)[0])[a];
      if (level) return a == c ? unit * beta_ : 0;
    }
  }
  return unit * (alpha_ / share + beta_);
}

double CheckedFacets::offset_underflow() const {
  const double least = std::numeric_limits<double>::denorm_min();
  return wild_ ? least : least * 4 * d_ * std::max(largest_, 1.0) + least;
}

bool CheckedFacets::is_corner(std::uint32_t simplex, std::uint32_t v) const {
  const std::uint32_t* const corners = s_.simplex(simplex);
  return std::find(corners, corners + k_, v) != corners + k_;
}

/// Whether the edge is so long that its products do not underflow and its scaling was exact.
bool CheckedFacets::in_range(std::uint32_t from, std::uint32_t to) const {
  double most = 0;
  for (unsigned c = 0; c < d_; ++c) most = std::max(most, std::fabs(at(to)[c] - at(from)[c]));
  return most > least_edge;
}

template <unsigned K, class Real>
bool CheckedFacets::by_cofactors(std::uint32_t simplex, FacetTerms& out) const {
  const std::uint32_t* v = s_.simplex(simplex);
  double rows[K - 1][K], n[K], spread[K];
  double lengths = 1;
  for (unsigned i = 1; i < K; ++i) {
    double most = 0;
    for (unsigned c = 0; c < K; ++c) {
      rows[i - 1][c] = at(v[i])[c] - at(v[0])[c];
      most = std::max(most, std::fabs(rows[i - 1][c]));
    }
    if (!(most > least_edge)) return false;
    lengths *= length(rows[i - 1], K);
  }
  normal_and_spread<K>(rows, n, spread);
  if constexpr (!std::is_same_v<Real, double>) {
    Real edges[K - 1][K], normal[K];
    for (unsigned i = 1; i < K; ++i)
      for (unsigned c = 0; c < K; ++c)
        edges[i - 1][c] = DoubleDouble::sum(at(v[i])[c], -at(v[0])[c]);
    cofactors<K, Real>(edges, normal);
    for (unsigned c = 0; c < K; ++c) n[c] = normal[c].value();
  }
  const double l = length(n, K);
  constexpr double least = std::is_same_v<Real, double> ? 0x1p-12 : 0x1p-40;
  if (!(l > least * lengths && l > 0x1p-400)) return false;
  out.normal.resize(K);
  out.spread.resize(K);
  const double per_length = 1 / lengths;
  for (unsigned c = 0; c < K; ++c) {
    out.normal[c] = n[c] / l;
    out.spread[c] = spread[c] * per_length;
  }
  out.lengths = lengths;
  out.share = l / lengths;
  return true;
}

bool CheckedFacets::quickly(std::uint32_t i, FacetTerms& out) const {
  if (k_ == 1 || wild_) return false;
  if (k_ != d_ || k_ > 8) return orthogonally(i, out);
  return with_dimension<2, 7, 8>(k_, [&](auto k) {
    return by_cofactors<k, double>(i, out) || by_cofactors<k, DoubleDouble>(i, out);
  });
}

bool CheckedFacets::orthogonally(std::uint32_t i, FacetTerms& out) const {
  const std::uint32_t* v = s_.simplex(i);
  Orthogonal<DoubleDoubles> o(DoubleDoubles{}, d_);
  for (unsigned j = 1; j < k_; ++j)
    if (!in_range(v[0], v[j]) || !o.add_edge(at(v[0]), at(v[j]))) return false;
  // Orthonormal to 2^-100 / share of the simplex: at least 60 bits remain.
  if (!(o.measure.high > 0x1p-36 * o.lengths.high)) return false;
  for (const std::uint32_t b : s_.basis)
    if (in_range(v[0], b) && !is_corner(i, b)) o.offer_apex(at(v[0]), at(b));
  if (o.outward.empty() || !(o.upright.high > 0x1p-24)) return false;
  out.normal.resize(d_);
  out.spread.clear();
  for (unsigned c = 0; c < d_; ++c) out.normal[c] = o.outward[c].value();
  out.lengths = o.lengths.value();
  out.share = o.measure.value() / out.lengths;
  return out.lengths > 0x1p-400;
}

mp_bitcnt_t CheckedFacets::wide_bits(std::uint32_t simplex) const {
  int low = 0, high = 0;
  bool any = false;
  const auto see = [&](std::uint32_t v) {
    for (unsigned c = 0; c < d_; ++c) {
      const double x = s_.full[std::size_t{v} * d_ + c];
      if (x == 0) continue;
      const int bottom = lowest_bit_exponent(x), top = std::ilogb(x) + 1;
      low = any ? std::min(low, bottom) : bottom;
      high = any ? std::max(high, top) : top;
      any = true;
    }
  };
  for (unsigned j = 0; j < k_; ++j) see(s_.simplex(simplex)[j]);
  for (const std::uint32_t b : s_.basis) see(b);
  see(0);
  // An edge's remainder is a quotient of Gram minors, integers in units of 2^(2 low): at least
  // 2^-(k (high - low + 8)) of the edge. The same number of bits again for rounding.
  return static_cast<mp_bitcnt_t>(2 * k_) * static_cast<mp_bitcnt_t>(high - low + 8) + 256;
}

/// The cofactor normal in integers: axes of any proportions need no more bits, and nothing is
/// rounded.
WideTerms CheckedFacets::exact_cofactors(std::uint32_t i, const double* origin) const {
  constexpr mp_bitcnt_t bits = 256;
  const auto row = [&](std::uint32_t v) { return s_.full.data() + std::size_t{v} * d_; };
  const std::uint32_t* v = s_.simplex(i);
  std::vector<const double*> corners;
  for (unsigned j = 0; j < k_; ++j) corners.push_back(row(v[j]));
  ExactPlane plane;
  plane.set(k_, corners.data());
  if (plane.degenerate()) fault("simplex ", i, " is degenerate");
  const auto rounded = [](const ExactPlane::ScaledInteger& n) {
    mpf_class value(0, bits);
    mpf_set_z(value.get_mpf_t(), n.value);
    return times_power_of_two(std::move(value), n.exponent);
  };
  Sign inner = Sign::zero;
  for (std::size_t b = 0; b < s_.basis.size() && inner == Sign::zero; ++b)
    inner = plane.side(row(s_.basis[b]));
  if (inner == Sign::zero) fault("the plane of simplex ", i, " holds all vertices");
  WideTerms w{{}, mpf_class(1, bits), mpf_class(0, bits), mpf_class(0, bits), {}};
  for (unsigned c = 0; c < k_; ++c) {
    w.normal.push_back(rounded(plane.cofactor(c)));
    w.measure += w.normal[c] * w.normal[c];
  }
  w.measure = sqrt(w.measure);
  for (mpf_class& n : w.normal)
    n = inner == Sign::positive ? mpf_class(-n / w.measure) : mpf_class(n / w.measure);
  if (origin != nullptr) {
    const mpf_class determinant = rounded(plane.determinant(origin));
    w.height = (inner == Sign::positive ? determinant : mpf_class(-determinant)) / w.measure;
  }
  for (unsigned j = 1; j < k_; ++j) {
    mpf_class square(0, bits);
    std::vector<mpf_class> edge;
    for (unsigned c = 0; c < k_; ++c) {
      edge.push_back(mpf_class(corners[j][c], bits) - mpf_class(corners[0][c], bits));
      square += edge[c] * edge[c];
    }
    const mpf_class length = sqrt(square);
    w.lengths *= length;
    for (const mpf_class& step : edge)
      w.unit_edges.push_back(length > 0 ? mpf_class(step / length).get_d() : 0);
  }
  return w;
}

WideTerms CheckedFacets::wide_terms(std::uint32_t i) const {
  s_.exact_decisions.fetch_add(1, std::memory_order_relaxed);
  if (is_simplex()) return simplex_terms_[i];
  const auto row = [&](std::uint32_t v) { return s_.full.data() + std::size_t{v} * d_; };
  std::vector<const double*> scratch(k_ + 1);
  const bool level = s_.side(i, s_.row(0), scratch.data()) == Sign::zero;
  const double* const origin = level ? nullptr : row(0);
  if (k_ == d_ && k_ >= 2) return exact_cofactors(i, origin);
  const std::uint32_t* v = s_.simplex(i);
  const mp_bitcnt_t enough = wide_bits(i);
  // Flats of frames whose axes differ extremely are tested by a bound for each component; the
  // smallest components matter, hence more bits at first.
  for (mp_bitcnt_t bits = wild_ && k_ < d_ ? 8192 : 512;; bits *= 4) {
    const bool last = bits >= enough;
    Orthogonal<WideFloats> o(WideFloats{last ? enough : bits}, d_);
    bool whole = true;
    for (unsigned j = 1; j < k_ && whole; ++j) whole = o.add_edge(row(v[0]), row(v[j]));
    if (!whole && last) fault("simplex ", i, " is degenerate");
    if (!whole) continue;
    for (const std::uint32_t b : s_.basis)
      if (!is_corner(i, b)) o.offer_apex(row(v[0]), row(b));
    if (o.outward.empty() && last) fault("the plane of simplex ", i, " holds all vertices");
    if (!last && !o.trusted(bits)) continue;
    mpf_class height(0, last ? enough : bits);
    if (!level && !o.find_height(row(v[0]), origin, bits, height) && !last) continue;
    return {std::move(o.outward), std::move(o.lengths), std::move(o.measure), std::move(height),
            std::move(o.unit_edges)};
  }
}

template <unsigned K>
void CheckedFacets::fill_spread(const WideTerms& w, FacetTerms& out) const {
  double rows[K - 1][K];
  for (unsigned i = 0; i + 1 < K; ++i)
    for (unsigned c = 0; c < K; ++c) rows[i][c] = w.unit_edges[std::size_t{i} * K + c];
  double normal[K];
  out.spread.resize(K);
  normal_and_spread<K>(rows, normal, out.spread.data());
}

void CheckedFacets::rounded_terms(const WideTerms& w, FacetTerms& out) const {
  out.normal.clear();
  for (const mpf_class& n : w.normal) out.normal.push_back(n.get_d());
  out.share = mpf_class(w.measure / w.lengths).get_d();
  const long shift = -static_cast<long>(exponent_) * static_cast<long>(k_ - 1);
  out.lengths = times_power_of_two(w.lengths, shift).get_d();
  out.spread.clear();
  if (k_ == d_ && k_ >= 2 && k_ <= 8)
    with_dimension<2, 7, 8>(k_, [&](auto k) { fill_spread<k>(w, out); });
  out.spread_length = length(out.spread.data(), static_cast<unsigned>(out.spread.size()));
}

void CheckedFacets::terms(std::uint32_t simplex, FacetTerms& out) const {
  if (is_simplex() || !quickly(simplex, out)) return rounded_terms(wide_terms(simplex), out);
  out.spread_length = length(out.spread.data(), static_cast<unsigned>(out.spread.size()));
}

}  // namespace cullhull::internal::certify
