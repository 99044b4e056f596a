// Compares planes, volume, area and centroid with the accuracy that the library documents. The
// check's own error is at most a quarter of the documented bound; a value within 1.25 times the
// bound is accepted. docs/exactness.md, "Numbers", derives both.
#include <algorithm>
#include <cmath>
#include <limits>

#include "certify/hull/facet_terms.hpp"
#include "exact/numbers/double_double.hpp"

namespace cullhull::internal::certify {
namespace {

constexpr double unit = CheckedFacets::unit;
/// Factor of the bound that allows for the check's own error.
constexpr double with_own = 1.25;

/// Magnitudes from here on round to infinity: the largest double plus half a unit in its last
/// place.
mpf_class beyond_doubles() { return times_power_of_two(mpf_class(1 - 0x1p-54, 256), 1024); }

// ---------------------------------------------------------------------------------------------
// Planes

class PlaneCheck {
 public:
  PlaneCheck(const Subject& s, const CheckedFacets& facets)
      : s_(s), h_(s.hull), f_(facets), d_(s.hull.dimension), k_(s.k) {}

  /// Checks the plane of a facet that is one simplex.
  void check_simplex(std::uint32_t f, const FacetTerms& terms) const {
    if (!normal_fits(f, f, terms)) wrong_normal(f);
    check_offset(f, f);
  }

  void run() const {
    check_chunks(s_.run, h_.facets.size(), std::uint64_t{1} << 12,
                 [&](std::uint64_t begin, std::uint64_t end) {
      FacetTerms terms;
      for (std::uint64_t f = begin; f < end; ++f) check(static_cast<std::uint32_t>(f), terms);
    });
  }

 private:
  const double* plane(std::uint32_t f) const {
    return h_.facet_planes.data() + std::size_t{f} * (d_ + 1);
  }

  void check(std::uint32_t f, FacetTerms& terms) const {
    if (k_ > 8) s_.run.check();
    const auto own = s_.members[f];
    // Checks against the plane of a facet's widest simplex, as far as doubles determine which it
    // is.
    double widest = 0;
    if (own.size() > 1)
      for (const std::uint32_t i : own) {
        f_.terms(i, terms);
        widest = std::max(widest, terms.share * terms.lengths);
      }
    bool right = false;
    for (const std::uint32_t i : own) {
      f_.terms(i, terms);
      right = terms.share * terms.lengths >= widest / 2 && normal_fits(f, i, terms);
      if (right) break;
    }
    if (!right) wrong_normal(f);
    check_offset(f, own[0]);
  }

  [[noreturn]] static void wrong_normal(std::uint32_t f) {
    fault("the normal of facet ", f, " is wrong");
  }

  bool normal_fits(std::uint32_t f, std::uint32_t simplex, const FacetTerms& terms) const {
    for (unsigned c = 0; c < d_; ++c) {
      const double bound = f_.normal_bound(terms, simplex, c), n = plane(f)[c];
      if (bound == 0 ? n != 0 : !(std::fabs(n - terms.normal[c]) <= with_own * bound)) return false;
    }
    return true;
  }

  /// Checks that the plane contains the first vertex of the facet's simplices.
  void check_offset(std::uint32_t f, std::uint32_t simplex) const {
    const double* p = plane(f);
    const std::uint32_t vertex = s_.simplex(simplex)[0];
    const double* v = s_.full.data() + std::size_t{vertex} * d_;
    DoubleDouble sum = p[d_];
    double terms = 0;
    bool surely = std::fabs(p[d_]) < 0x1p900;  // no product overflows, no error term underflows
    for (unsigned c = 0; c < d_; ++c) {
      if (p[c] == 0 || v[c] == 0) continue;
      const double size = std::fabs(p[c] * v[c]);
      surely = surely && size > 0x1p-900 && std::fabs(v[c]) < 0x1p900;
      if (!surely) break;
      sum = sum + DoubleDouble::product(p[c], v[c]);
      terms += size;
    }
    const bool right =
        surely ? std::fabs(sum.value()) <= offset_roundings() * terms + f_.offset_underflow()
               : offset_fits(p, v);
    if (!right)
      fault("the offset of facet ", f, " is wrong: its plane misses vertex ", s_.ids[vertex]);
  }
  double offset_roundings() const { return (d_ + 5) * unit; }

  /// The same for numbers of any magnitude.
  bool offset_fits(const double* p, const double* v) const {
    constexpr mp_bitcnt_t bits = 4608;  // holds the sum of products of doubles
    mpf_class sum(0, bits), terms(0, bits);
    for (unsigned c = 0; c < d_; ++c) {
      const mpf_class product = mpf_class(p[c], bits) * mpf_class(v[c], bits);
      sum += product;
      terms += abs(product);
    }
    const mpf_class bound = offset_roundings() * terms + f_.offset_underflow();
    if (std::isnan(p[d_])) return false;
    if (std::isfinite(p[d_])) return abs(sum + mpf_class(p[d_], bits)) <= bound;
    const mpf_class expected = -sum, limit = beyond_doubles();
    return p[d_] > 0 ? expected + bound >= limit : expected - bound <= -limit;
  }

  const Subject& s_;
  const Hull& h_;
  const CheckedFacets& f_;
  const unsigned d_, k_;
};

// ---------------------------------------------------------------------------------------------
// Measures

/// Sums over simplices, each with its error bound.
template <class Sum, class Bound>
struct Sums {
  Sum volume, area;
  std::vector<Sum> moment;
  Bound volume_bound, area_bound;
  Bound in_doubles;  ///< what the library compares with the volume, to choose its arithmetic

  Sums(unsigned d, const Sum& zero, const Bound& none)
      : volume(zero),
        area(zero),
        moment(d, zero),
        volume_bound(none),
        area_bound(none),
        in_doubles(none) {}
  void add(const Sums& o) {
    volume = volume + o.volume;
    area = area + o.area;
    for (std::size_t c = 0; c < moment.size(); ++c) moment[c] = moment[c] + o.moment[c];
    volume_bound += o.volume_bound;
    area_bound += o.area_bound;
    in_doubles += o.in_doubles;
  }
};
using QuickSums = Sums<DoubleDouble, double>;
using WideSums = Sums<mpf_class, mpf_class>;

class MeasureCheck {
 public:
  MeasureCheck(const Subject& s, const CheckedFacets& facets)
      : s_(s), h_(s.hull), f_(facets), planes_(s, facets), d_(s.hull.dimension), k_(s.k) {}

  /// Checks measures, and in the same pass the planes of facets that are simplices.
  void run() const {
    if (!single()) planes_.run();
    if (quick()) {
      const QuickSums q = quick_sums();
      if (settled(q)) return compare(widened(q), f_.exponent());
    }
    compare(wide_sums(), 0);
  }

 private:
  bool quick() const { return k_ > 1 && !f_.wild() && !f_.is_simplex(); }
  /// Whether the bounds added up with the sums are tighter than relative_bound(). Far from
  /// underflow the sums lost nothing, even if terms of single simplices did.
  bool settled(const QuickSums& q) const {
    return q.volume.high > 0x1p-500 && q.area.high > 0x1p-500 && q.volume.high < 0x1p900 &&
           q.volume_bound <= tight() * q.volume.high && q.area_bound <= tight() * q.area.high;
  }
  /// The relative bound above which sums are computed exactly.
  double tight() const { return many() ? 0x1p-38 : f_.relative_bound(); }
  /// Beyond eight dimensions volume and area are bounded by what is lost in facets as thin as these
  /// are.
  bool many() const { return k_ > 8; }
  bool single() const { return s_.all_simple(); }

  /// Error bounds of the measure of a simplex's parallelotope and of its product with the height;
  /// `reach` is the vector to the apex. The product of the edges' lengths and the measure are
  /// passed separately, because their quotient may be outside the range of doubles.
  template <class Number>
  Number area_bound(const FacetTerms& t, const Number& lengths, const Number& measure) const {
    if (many()) return unit * f_.loss(t) * measure;
    const double spread = f_.by_component() ? t.spread_length : 1;
    return unit * (f_.alpha() * spread * thin(t) * lengths + f_.beta() * measure);
  }
  template <class Number>
  Number volume_bound(const FacetTerms& t, const std::vector<Number>& normal,
                      const std::vector<Number>& reach, const Number& zero, const Number& lengths,
                      const Number& measure) const {
    using std::abs;
    using std::sqrt;
    Number lost = zero, kept = zero;
    if (f_.by_component()) {
      for (std::size_t c = 0; c < t.spread.size(); ++c) lost += t.spread[c] * abs(reach[c]);
      for (unsigned c = 0; c < d_; ++c) kept += abs(normal[c] * reach[c]);
    } else {
      for (unsigned c = 0; c < d_; ++c) kept += reach[c] * reach[c];
      lost = kept = sqrt(kept);
      if (many()) return unit * f_.loss(t) * kept * measure;
    }
    return unit * (f_.alpha() * thin(t) * lost * lengths + f_.beta() * kept * measure);
  }
  /// The share of a simplex of the sum by which the library chooses its arithmetic.
  template <class Number>
  Number in_doubles(const std::vector<Number>& reach, const Number& zero,
                    const Number& measure) const {
    using std::abs;
    Number most = zero;
    for (const Number& r : reach)
      if (abs(r) > most) most = abs(r);
    return unit * most * measure;
  }
  double thin(const FacetTerms& t) const {
    return std::min(1.0, t.share / f_.careful_share()) + 0x1p-48;
  }
  QuickSums quick_sums() const {
    constexpr std::uint64_t chunk = std::uint64_t{1} << 12;  // tens of us of work
    std::vector<QuickSums> parts((s_.simplex_count() + chunk - 1) / chunk, QuickSums(d_, 0.0, 0.0));
    check_chunks(s_.run, s_.simplex_count(), chunk, [&](std::uint64_t begin, std::uint64_t end) {
      FacetTerms terms;
      std::vector<double> reach(d_);
      for (std::uint64_t i = begin; i < end; ++i) {
        if (k_ > 8) s_.run.check();
        add(static_cast<std::uint32_t>(i), terms, reach, parts[begin / chunk]);
      }
    });
    QuickSums all(d_, 0.0, 0.0);
    for (const QuickSums& p : parts) all.add(p);
    return all;
  }

  void add(std::uint32_t i, FacetTerms& t, std::vector<double>& reach, QuickSums& out) const {
    f_.terms(i, t);
    if (single()) planes_.check_simplex(i, t);
    const std::uint32_t* v = s_.simplex(i);
    const double* o = f_.at(0);
    double height = 0;
    for (unsigned c = 0; c < d_; ++c) {
      reach[c] = f_.at(v[0])[c] - o[c];
      height += t.normal[c] * reach[c];
    }
    const double area = t.share * t.lengths, volume = height * area;
    out.area = out.area + DoubleDouble(area);
    out.volume = out.volume + DoubleDouble(volume);
    out.area_bound += area_bound(t, t.lengths, area);
    out.volume_bound += volume_bound(t, t.normal, reach, 0.0, t.lengths, area);
    if (many()) out.in_doubles += in_doubles(reach, 0.0, area);
    for (unsigned c = 0; c < d_; ++c) {
      double sum = 0;
      for (unsigned j = 0; j < k_; ++j) sum += f_.at(v[j])[c] - o[c];
      out.moment[c] = out.moment[c] + DoubleDouble(volume * sum);
    }
  }

  static mpf_class widened(const DoubleDouble& v) {
    return mpf_class(v.high, 256) + mpf_class(v.low, 256);
  }
  WideSums widened(const QuickSums& q) const {
    WideSums w(d_, mpf_class(0, 256), mpf_class(0, 256));
    w.volume = widened(q.volume);
    w.area = widened(q.area);
    for (unsigned c = 0; c < d_; ++c) w.moment[c] = widened(q.moment[c]);
    w.volume_bound = q.volume_bound;
    w.area_bound = q.area_bound;
    w.in_doubles = q.in_doubles;
    return w;
  }

  WideSums wide_sums() const {
    const std::uint64_t chunk = many() ? 4 : 256;  // GMP: microseconds per facet, or milliseconds
    constexpr mp_bitcnt_t bits = 4608;             // holds sums of products of doubles
    const WideSums none(d_, mpf_class(0, bits), mpf_class(0, 256));
    std::vector<WideSums> parts((s_.simplex_count() + chunk - 1) / chunk, none);
    check_chunks(s_.run, s_.simplex_count(), chunk, [&](std::uint64_t begin, std::uint64_t end) {
      for (std::uint64_t i = begin; i < end; ++i) {
        s_.run.check();
        add_wide(static_cast<std::uint32_t>(i), bits, parts[begin / chunk]);
      }
    });
    WideSums all = none;
    for (const WideSums& p : parts) all.add(p);
    all.volume_bound = std::min(all.volume_bound, mpf_class(all.volume * f_.relative_bound()));
    all.area_bound = std::min(all.area_bound, mpf_class(all.area * f_.relative_bound()));
    return all;
  }

  void add_wide(std::uint32_t i, mp_bitcnt_t bits, WideSums& out) const {
    const WideTerms w = f_.wide_terms(i);
    FacetTerms t;
    f_.rounded_terms(w, t);
    if (single() && !quick()) planes_.check_simplex(i, t);
    const std::uint32_t* v = s_.simplex(i);
    const auto at = [&](std::uint32_t vertex) { return s_.full.data() + std::size_t{vertex} * d_; };
    const double* o = at(0);
    std::vector<mpf_class> reach;
    for (unsigned c = 0; c < d_; ++c)
      reach.push_back(mpf_class(at(v[0])[c], bits) - mpf_class(o[c], bits));
    const mpf_class volume(w.height * w.measure, bits);
    out.area += w.measure;
    out.volume += volume;
    out.area_bound += area_bound(t, w.lengths, w.measure);
    out.volume_bound += volume_bound(t, w.normal, reach, mpf_class(0, bits), w.lengths, w.measure);
    if (many()) out.in_doubles += in_doubles(reach, mpf_class(0, bits), w.measure);
    for (unsigned c = 0; c < d_; ++c) {
      mpf_class sum(0, bits);
      for (unsigned j = 0; j < k_; ++j) sum += mpf_class(at(v[j])[c], bits) - mpf_class(o[c], bits);
      out.moment[c] += volume * sum;
    }
  }

  /// Beyond eight dimensions: 2^-40 of the values, and what sums in doubles lose. The library
  /// computes with more bits where `in_doubles` is above 2^-42 of the volume; in flats it sees a
  /// projection, so that this sum is not known here.
  void tighten(WideSums& t) const {
    if (k_ == d_ && t.in_doubles > t.volume * 0x1p-41) t.volume_bound = t.area_bound = 0;
    t.volume_bound = std::min(mpf_class(t.volume_bound + t.volume * 0x1p-40),
                              mpf_class(t.volume * f_.relative_bound()));
    t.area_bound = std::min(mpf_class(t.area_bound + t.area * 0x1p-40),
                            mpf_class(t.area * f_.relative_bound()));
  }

  /// Compares the hull's measures with `t`, whose unit of length is 2^exponent.
  void compare(WideSums t, long exponent) const {
    if (many()) tighten(t);
    mpf_class factorial(1, 256);
    for (unsigned i = 2; i < k_; ++i) factorial *= i;
    const long k = k_;
    if (!(t.volume > 0)) fault("the hull has no volume");
    compare("area", h_.area, times_power_of_two(t.area / factorial, exponent * (k - 1)),
            times_power_of_two(t.area_bound / factorial, exponent * (k - 1)));
    const mpf_class share = factorial * k_;
    compare("volume", h_.volume, times_power_of_two(t.volume / share, exponent * k),
            times_power_of_two(t.volume_bound / share, exponent * k));
    const mpf_class relative = t.volume_bound / t.volume;
    for (unsigned c = 0; c < d_; ++c) {
      const mpf_class shift = times_power_of_two(t.moment[c] / (t.volume * (k_ + 1)), exponent);
      check_centroid(c, shift, relative);
    }
  }

  /// Half of the least denormal number, below which no relative bound holds.
  static mpf_class least() {
    return mpf_class(std::numeric_limits<double>::denorm_min(), 256) * 0.5;
  }

  void compare(const char* what, double given, const mpf_class& expected,
               const mpf_class& bound) const {
    const mpf_class allowed = bound * with_own + least();
    const mpf_class limit = beyond_doubles();
    if (given == std::numeric_limits<double>::infinity() && expected + allowed >= limit) return;
    if (given >= 0 && std::isfinite(given) && abs(mpf_class(given, 256) - expected) <= allowed)
      return;
    const std::string right = expected >= limit ? "inf" : number(expected.get_d());
    fault("the ", what, " ", number(given), " should be ", right);
  }

  static std::string number(double v) {
    char text[32];
    std::snprintf(text, sizeof text, "%.17g", v);
    return text;
  }

  void check_centroid(unsigned c, const mpf_class& shift, const mpf_class& relative) const {
    const double origin = s_.full[c];
    mpf_class extent(0, 256);
    const double low = s_.low[c], high = s_.high[c];
    extent = mpf_class(high, 256) - mpf_class(low, 256);
    const double given = h_.centroid[c];
    if (given < low || given > high)
      fault("coordinate ", c, " of the centroid, ", number(given), ", is outside of the hull");
    const mpf_class expected = mpf_class(origin, shift.get_prec()) + shift;
    // Two of the 4 units of the value are for a file's hull, converted from a grid to world
    // coordinates and back.
    const mpf_class allowed =
        (2 * relative + f_.beta() * unit) * with_own * extent + 4 * unit * abs(expected) + least();
    if (!std::isfinite(given) || abs(mpf_class(given, 256) - expected) > allowed)
      fault("coordinate ", c, " of the centroid, ", number(given), ", should be ",
            number(expected.get_d()));
  }

  const Subject& s_;
  const Hull& h_;
  const CheckedFacets& f_;
  const PlaneCheck planes_;
  const unsigned d_, k_;
};

}  // namespace

void check_numbers(const Subject& s) {
  const CheckedFacets facets(s);
  MeasureCheck(s, facets).run();
}

}  // namespace cullhull::internal::certify
