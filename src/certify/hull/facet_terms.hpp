// Unit normals of facets and bounds on the error of the library's own arithmetic: the values with
// which certify() compares planes and measures. docs/exactness.md, "Numbers".
#pragma once

#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

#include "certify/certificate.hpp"
#include "exact/numbers/gmpxx.hpp"

namespace cullhull::internal::certify {

inline mpf_class times_power_of_two(mpf_class v, long e) {
  if (e >= 0)
    mpf_mul_2exp(v.get_mpf_t(), v.get_mpf_t(), static_cast<mp_bitcnt_t>(e));
  else
    mpf_div_2exp(v.get_mpf_t(), v.get_mpf_t(), static_cast<mp_bitcnt_t>(-e));
  return v;
}

/// The normal and bounds of one simplex. Lengths are in the units of CheckedFacets::at.
struct FacetTerms {
  std::vector<double> normal;  ///< outward, of length 1, in the flat
  std::vector<double> spread;  ///< p of the bound; empty if the bound does not use it
  double spread_length = 0;    ///< |p|
  double lengths = 0;          ///< product of the lengths of the edges from the first vertex
  double share = 0;            ///< measure of the edges' parallelotope over that product
};

/// The same in numbers without limits of magnitude, for sums over hulls of extreme proportions.
struct WideTerms {
  std::vector<mpf_class> normal;
  mpf_class lengths, measure;
  mpf_class height;                ///< of the plane over vertex 0; exactly 0 if that is on it
  std::vector<double> unit_edges;  ///< rows, each of length 1
};

/// The facets of a hull whose surface has been verified. Thread safe.
class CheckedFacets {
 public:
  explicit CheckedFacets(const Subject& s);

  /// Coordinates of a vertex in units of 2^exponent(), exact unless they underflow.
  const double* at(std::uint32_t v) const { return rows_ + std::size_t{v} * d_; }
  int exponent() const { return exponent_; }
  /// Whether the axes' extents differ so much that doubles in a common unit underflow on some axis.
  bool wild() const { return wild_; }
  /// Whether the hull is a simplex of so many dimensions that its terms are found together.
  bool is_simplex() const { return !simplex_terms_.empty(); }
  /// The greatest change of an offset by underflow: 0 if axes differ so much that the library
  /// computes planes exactly.
  double offset_underflow() const;

  /// Sets `normal`, each component within 1/4 of `normal_bound`, and `share`, within 2^-20
  /// relatively.
  void terms(std::uint32_t simplex, FacetTerms& out) const;
  /// The wide terms, in units of 1.
  WideTerms wide_terms(std::uint32_t simplex) const;
  /// Rounds wide_terms() to the result of terms().
  void rounded_terms(const WideTerms& w, FacetTerms& out) const;
  mp_bitcnt_t wide_bits(std::uint32_t simplex) const;

  /// The greatest documented error of component c of a plane's normal.
  double normal_bound(const FacetTerms& t, std::uint32_t simplex, unsigned c) const;
  /// Whether the bound is given for each component, by `spread`.
  bool by_component() const { return k_ == 1 || (k_ == d_ && k_ <= 8); }
  /// The greatest documented relative error of volume and area, for simplices of any thinness.
  /// Below 1/2.
  double relative_bound() const { return relative_; }
  double alpha() const { return alpha_; }  ///< per unit of `spread`, else of `lengths`
  double beta() const { return beta_; }    ///< per unit of the normal itself
  /// For k > 8: the greatest relative error of a simplex's measure, and of its height over the
  /// distance, in units of 2^-53. Edges in random directions have a share of about `usual_share`; a
  /// smaller share magnifies rounding by as much.
  double loss(const FacetTerms& t) const {
    return loss_ * std::max(1.0, usual_share_ / std::max(t.share, careful_share_));
  }

  static constexpr double unit = 0x1p-53;
  /// The library computes planes and measures of simplices with a smaller share with more bits than
  /// doubles have.
  double careful_share() const { return careful_share_; }

 private:
  /// False if more bits are needed.
  bool find_simplex_terms(mp_bitcnt_t bits);
  template <unsigned K, class Real>
  bool by_cofactors(std::uint32_t simplex, FacetTerms& out) const;
  bool quickly(std::uint32_t simplex, FacetTerms& out) const;
  bool orthogonally(std::uint32_t simplex, FacetTerms& out) const;
  /// In full dimension. `origin`: null if that is on the plane.
  WideTerms exact_cofactors(std::uint32_t simplex, const double* origin) const;
  template <unsigned K>
  void fill_spread(const WideTerms& w, FacetTerms& out) const;
  bool in_range(std::uint32_t from, std::uint32_t to) const;
  bool is_corner(std::uint32_t simplex, std::uint32_t v) const;

  const Subject& s_;
  const unsigned d_, k_;
  int exponent_ = 0;
  double largest_ = 0;  ///< largest |coordinate|, as given
  bool wild_ = false;   ///< some axis' extent is below 2^-400 of largest_
  const double* rows_;
  std::vector<double> scaled_;
  std::vector<std::uint8_t> constant_;  ///< axes orthogonal to the flat
  double alpha_ = 0, beta_ = 0, careful_share_ = 0x1p-13, relative_ = 0.25;
  double usual_share_ = 1, loss_ = 0;
  std::vector<WideTerms> simplex_terms_;
};

}  // namespace cullhull::internal::certify
