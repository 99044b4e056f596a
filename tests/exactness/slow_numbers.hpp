// What planes and measures of a small hull are, in rational arithmetic by the shortest way, and how
// far from that docs/exactness.md ("Numbers") lets the library be. Shares nothing with either.
#pragma once

#include <gmpxx.h>

#include <cmath>
#include <limits>
#include <map>
#include <vector>

#include "agreement/point_sets.hpp"
#include "cullhull/hull.hpp"

namespace cullhull::testing_support {

class SlowNumbers {
 public:
  using Vector = std::vector<mpq_class>;
  static constexpr mp_bitcnt_t bits = 1024;

  SlowNumbers(const PointSet& s, const Hull& h)
      : s_(s), h_(h), d_(h.dimension), k_(static_cast<unsigned>(h.affine_dimension)) {
    double largest = 0, narrowest = std::numeric_limits<double>::infinity();
    for (unsigned c = 0; c < d_; ++c) {
      mpq_class low = at(h.vertices[0])[c], high = low;
      for (const std::uint64_t v : h.vertices) {
        const mpq_class x = at(v)[c];
        low = std::min(low, x);
        high = std::max(high, x);
        largest = std::max(largest, std::fabs(s.row(v)[c]));
      }
      extent_.push_back(high - low);
      if (high != low) narrowest = std::min(narrowest, mpq_class(high / 2 - low / 2).get_d());
    }
    largest_ = largest;
    wild_ = !(narrowest > std::ldexp(largest, -399));
  }

  struct Plane {
    std::vector<mpf_class> normal;
    std::vector<mpf_class> bound;  ///< on each component, as documented
    mpf_class measure;
  };

  /// Of one simplex of the hull.
  const Plane& plane(std::uint64_t simplex) {
    const auto known = planes_.find(simplex);
    if (known != planes_.end()) return known->second;
    return planes_[simplex] = make_plane(simplex);
  }

  enum class Verdict { right, doubtful, wrong };

  /// Of a row of facet_planes.
  Verdict judge(std::uint64_t facet, const double* row) {
    mpf_class widest(0, bits);
    std::vector<std::uint64_t> members;
    for (std::uint64_t i = 0; i < h_.simplex_count(); ++i)
      if (h_.simplex_facets[i] == facet) members.push_back(i);
    for (const std::uint64_t i : members)
      if (plane(i).measure > widest) widest = plane(i).measure;
    Verdict best = Verdict::wrong;
    for (const std::uint64_t i : members) {
      const Plane& p = plane(i);
      if (p.measure < widest * 0.49) continue;  // certify() takes what may be the widest
      Verdict all = Verdict::right;
      for (unsigned c = 0; c < d_; ++c) {
        if (!std::isfinite(row[c])) return Verdict::wrong;
        all = std::max(all, verdict(abs(mpf_class(row[c], bits) - p.normal[c]), p.bound[c]));
      }
      // Only the widest itself is documented.
      if (p.measure < widest && all == Verdict::right) all = Verdict::doubtful;
      best = std::min(best, all);
    }
    return std::max(best, judge_offset(h_.simplices[members[0] * k_], row));
  }

  Verdict judge_volume(double v) { return measure(v, sums().volume, sums().volume_bound); }
  Verdict judge_area(double v) { return measure(v, sums().area, sums().area_bound); }
  Verdict judge_centroid(unsigned c, double v) {
    if (!std::isfinite(v)) return Verdict::wrong;
    const Sums& t = sums();
    if (v < lowest(c) || mpq_class(v) > mpq_class(lowest(c)) + extent_[c]) return Verdict::wrong;
    const mpf_class exact = t.centroid[c];
    const mpf_class bound = (2 * t.volume_bound / t.volume + beta() * unit) * big(extent_[c]) +
                            2 * unit * abs(exact) + half_least();
    return verdict(abs(mpf_class(v, bits) - exact), bound);
  }

 private:
  static constexpr double unit = 0x1p-53;
  struct Sums {
    mpf_class volume{0, bits}, area{0, bits}, volume_bound{0, bits}, area_bound{0, bits};
    std::vector<mpf_class> centroid;
  };

  static mpf_class big(const mpq_class& q) { return mpf_class(q, bits); }
  static mpf_class half_least() { return mpf_class(0x1p-1074, bits) / 2; }
  static Verdict verdict(const mpf_class& off, const mpf_class& bound) {
    if (off <= bound) return Verdict::right;
    return off <= 1.5 * bound ? Verdict::doubtful : Verdict::wrong;
  }
  static Verdict number(double v, const mpf_class& exact, const mpf_class& bound) {
    mpf_class limit(1 - 0x1p-54, bits);
    mpf_mul_2exp(limit.get_mpf_t(), limit.get_mpf_t(), 1024);
    if (std::isnan(v) || v == -std::numeric_limits<double>::infinity()) return Verdict::wrong;
    if (std::isinf(v))
      return exact + bound >= limit         ? Verdict::right
             : exact + 1.5 * bound >= limit ? Verdict::doubtful
                                            : Verdict::wrong;
    return verdict(abs(mpf_class(v, bits) - exact), bound + half_least());
  }

  static Verdict measure(double v, const mpf_class& exact, const mpf_class& bound) {
    return v < 0 ? Verdict::wrong : number(v, exact, bound);
  }
  double lowest(unsigned c) const {
    double low = s_.row(h_.vertices[0])[c];
    for (const std::uint64_t v : h_.vertices) low = std::min(low, s_.row(v)[c]);
    return low;
  }

  Vector at(std::uint64_t id) const {
    Vector v;
    for (unsigned c = 0; c < d_; ++c) v.emplace_back(s_.row(id)[c]);
    return v;
  }
  static Vector minus(const Vector& a, const Vector& b) {
    Vector r;
    for (std::size_t c = 0; c < a.size(); ++c) r.push_back(a[c] - b[c]);
    return r;
  }
  static mpq_class dot(const Vector& a, const Vector& b) {
    mpq_class r;
    for (std::size_t c = 0; c < a.size(); ++c) r += a[c] * b[c];
    return r;
  }
  /// What is left of a at right angles to `rests`, which are so to one another.
  static Vector free(Vector a, const std::vector<Vector>& rests) {
    for (const Vector& r : rests) {
      const mpq_class share = dot(a, r) / dot(r, r);
      for (std::size_t c = 0; c < a.size(); ++c) a[c] -= share * r[c];
    }
    return a;
  }
  /// Permanent of the rows from `row` on over the columns not in `used`.
  static double permanent(const std::vector<std::vector<double>>& m, std::size_t row,
                          unsigned used) {
    if (row == m.size()) return 1;
    double sum = 0;
    for (unsigned c = 0; c < m[row].size(); ++c)
      if (!(used >> c & 1)) sum += m[row][c] * permanent(m, row + 1, used | 1U << c);
    return sum;
  }

  bool by_component() const { return k_ == 1 || (k_ == d_ && k_ <= 8); }
  double beta() const { return (2.0 * d_ + 48) * (by_component() || k_ == d_ ? 1 : 256); }
  double roundings() const {
    const double r = k_ - 1.0;
    return r + (r - 1) + r * (r - 1) / 2;
  }
  /// Of volume and area, relative to themselves.
  double relative() const {
    const double k = k_;
    if (k_ > 8) return std::min(0.25, 0x1p-23 * k * std::sqrt(std::pow(k, k) / std::tgamma(k + 1)));
    return 0x1p-29 * ((k_ == 1 ? 1 : roundings()) + 3) * std::tgamma(k + 1) /
           std::pow(k, (k - 1) / 2);
  }
  /// What eliminations of more than eight columns are done in doubles for.
  double careful() const {
    const double k = k_;
    return 0x1p-13 * (k_ > 8 ? std::sqrt(std::tgamma(k + 1) / std::pow(k, k)) : 1);
  }
  /// For k > 8: of a share of the sums, relative to itself and in units of 2^-53.
  double loss(double share) const {
    return std::max((k_ == d_ ? 16.0 : 256.0) * k_, 4.0 * (d_ + 4)) *
           std::max(1.0, 0x1p13 * careful() / std::max(share, careful()));
  }
  double alpha() const {
    const double r = k_ - 1.0, roundings = this->roundings();
    if (k_ == 1) return 0;
    if (by_component()) return 4 * (roundings + 3);
    return (k_ <= 8 ? 4 * (roundings + 3) * std::sqrt(k_) * std::pow(r, r / 2)
                    : 256 * std::sqrt(k_)) *
           (k_ < d_ ? 256 : 1);
  }

  struct Shape {
    mpf_class lengths, measure;
    std::vector<double> spread;
    double share;
    std::vector<Vector> rests;
  };
  Shape shape(std::uint64_t simplex) const {
    const std::uint64_t* v = h_.simplices.data() + simplex * k_;
    Shape out{mpf_class(1, bits), mpf_class(1, bits), {}, 0, {}};
    std::vector<std::vector<double>> units;
    for (unsigned j = 1; j < k_; ++j) {
      const Vector e = minus(at(v[j]), at(v[0]));
      const mpf_class whole = sqrt(big(dot(e, e)));
      units.emplace_back();
      for (const mpq_class& x : e)
        units.back().push_back(std::fabs(mpf_class(big(x) / whole).get_d()));
      out.rests.push_back(free(e, out.rests));
      out.lengths *= whole;
      out.measure *= sqrt(big(dot(out.rests.back(), out.rests.back())));
    }
    out.share = mpf_class(out.measure / out.lengths).get_d();
    if (by_component() && k_ > 1)
      for (unsigned c = 0; c < k_; ++c) out.spread.push_back(permanent(units, 0, 1U << c));
    return out;
  }

  Plane make_plane(std::uint64_t simplex) const {
    const Shape f = shape(simplex);
    const std::uint64_t first = h_.simplices[simplex * k_];
    Vector outward;
    for (const std::uint64_t v : h_.vertices) {
      outward = free(minus(at(first), at(v)), f.rests);
      if (dot(outward, outward) != 0) break;
    }
    Plane p;
    p.measure = f.measure;
    const mpf_class l = sqrt(big(dot(outward, outward)));
    for (const mpq_class& x : outward) p.normal.emplace_back(big(x) / l);
    double whole = 0;
    for (const double x : f.spread) whole += x * x;
    whole = std::sqrt(whole);
    const double share = std::max(f.share, careful());
    for (unsigned c = 0; c < d_; ++c) {
      const mpf_class own = abs(p.normal[c]);
      mpf_class bound = unit * beta() * own;
      if (by_component() && k_ > 1) bound += unit * alpha() / share * (f.spread[c] + own * whole);
      if (!by_component() && !(wild_ && k_ < d_)) bound = unit * (alpha() / share + beta());
      bound += wild_ ? 0x1p-1070 : 0x1p-500;
      if (!by_component() && extent_[c] == 0) bound = 0;
      p.bound.push_back(bound);
    }
    return p;
  }

  Verdict judge_offset(std::uint64_t vertex, const double* row) const {
    mpf_class sum(0, 8192), terms(0, 8192);
    for (unsigned c = 0; c < d_; ++c) {
      const mpf_class product = mpf_class(row[c], 8192) * mpf_class(s_.row(vertex)[c], 8192);
      sum -= product;
      terms += abs(product);
    }
    const double underflow =
        wild_ ? 0x1p-1074 : 0x1p-1074 * 4 * d_ * std::max(largest_, 1.0) + 0x1p-1074;
    const mpf_class bound = (d_ + 5) * unit * terms + underflow;
    if (std::isinf(row[d_]))
      return number(std::fabs(row[d_]), row[d_] < 0 ? mpf_class(-sum) : sum, bound);
    if (std::isnan(row[d_])) return Verdict::wrong;
    return verdict(abs(mpf_class(row[d_], 8192) - sum), bound);
  }

  const Sums& sums() {
    if (summed_) return sums_;
    summed_ = true;
    const Vector origin = at(*std::min_element(h_.vertices.begin(), h_.vertices.end()));
    std::vector<mpf_class> moment(d_, mpf_class(0, bits));
    for (std::uint64_t i = 0; i < h_.simplex_count(); ++i) add(i, origin, moment);
    mpf_class factorial(1, bits);
    for (unsigned j = 2; j < k_; ++j) factorial *= j;
    for (unsigned c = 0; c < d_; ++c)
      sums_.centroid.emplace_back(big(origin[c]) + moment[c] / (sums_.volume * (k_ + 1)));
    if (k_ > 8) {
      if (k_ == d_ && in_doubles_ > sums_.volume * 0x1p-41)
        sums_.area_bound = sums_.volume_bound = 0;
      sums_.area_bound += sums_.area * 0x1p-40;
      sums_.volume_bound += sums_.volume * 0x1p-40;
    }
    sums_.area /= factorial;
    sums_.area_bound /= factorial;
    sums_.volume /= factorial * k_;
    sums_.volume_bound /= factorial * k_;
    sums_.area_bound = std::min(sums_.area_bound, mpf_class(relative() * sums_.area));
    sums_.volume_bound = std::min(sums_.volume_bound, mpf_class(relative() * sums_.volume));
    return sums_;
  }
  void add(std::uint64_t i, const Vector& origin, std::vector<mpf_class>& moment) {
    const std::uint64_t* v = h_.simplices.data() + i * k_;
    const Shape f = shape(i);
    const Vector reach = minus(at(v[0]), origin);
    const Vector rest = free(reach, f.rests);
    const mpf_class height = sqrt(big(dot(rest, rest))), volume = height * f.measure;
    const double thin = std::min(1.0, f.share / careful()) + 0x1p-48;
    mpf_class spread(1, bits), lost(0, bits), kept(0, bits);
    if (by_component()) {
      double square = 0;
      for (const double x : f.spread) square += x * x;
      spread = std::sqrt(square);
      for (std::size_t c = 0; c < f.spread.size(); ++c) lost += f.spread[c] * abs(big(reach[c]));
      const Plane& p = plane(i);
      for (unsigned c = 0; c < d_; ++c) kept += abs(p.normal[c] * big(reach[c]));
    } else {
      lost = kept = sqrt(big(dot(reach, reach)));
    }
    sums_.area += f.measure;
    sums_.volume += volume;
    if (k_ > 8) {
      mpq_class most;
      for (const mpq_class& x : reach) most = std::max(most, mpq_class(abs(x)));
      in_doubles_ += unit * big(most) * f.measure;
      sums_.area_bound += unit * loss(f.share) * f.measure;
      sums_.volume_bound += unit * loss(f.share) * kept * f.measure;
    } else {
      sums_.area_bound += unit * (alpha() * spread * thin * f.lengths + beta() * f.measure);
      sums_.volume_bound += unit * (alpha() * lost * thin * f.lengths + beta() * kept * f.measure);
    }
    for (unsigned c = 0; c < d_; ++c) {
      mpq_class sum;
      for (unsigned j = 0; j < k_; ++j) sum += at(v[j])[c] - origin[c];
      moment[c] += volume * big(sum);
    }
  }

  const PointSet& s_;
  const Hull& h_;
  const unsigned d_, k_;
  Vector extent_;
  double largest_ = 0;
  bool wild_ = false, summed_ = false;
  std::map<std::uint64_t, Plane> planes_;
  Sums sums_;
  mpf_class in_doubles_ = mpf_class(0, bits);  ///< by which the library chooses its arithmetic
};

}  // namespace cullhull::testing_support
