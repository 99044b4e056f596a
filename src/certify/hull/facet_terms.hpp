// Unit normals of facets, and the error that the library's own arithmetic may have: the values that
// certify() compares planes and measures with. docs/exactness.md, "Numbers".
#pragma once

#include <gmpxx.h>

#include <cstdint>
#include <utility>
#include <vector>

#include "certify/certificate.hpp"

namespace cullhull::internal::certify {

inline mpf_class times_power_of_two(mpf_class v, long e) {
  if (e >= 0)
    mpf_mul_2exp(v.get_mpf_t(), v.get_mpf_t(), static_cast<mp_bitcnt_t>(e));
  else
    mpf_div_2exp(v.get_mpf_t(), v.get_mpf_t(), static_cast<mp_bitcnt_t>(-e));
  return v;
}

/// A simplex of the surface. Lengths are in the units of CheckedFacets::at.
struct FacetTerms {
  std::vector<double> normal;  ///< outward, of length 1, in the flat
  std::vector<double> spread;  ///< p of the bound; empty where the bound has none
  double spread_length = 0;    ///< |p|
  double lengths = 0;          ///< product of the edges' lengths from the first vertex
  double share = 0;            ///< measure of their parallelotope over that product
};

/// The same without a limit of magnitude, for sums over hulls of extreme proportions.
struct WideTerms {
  std::vector<mpf_class> normal;
  mpf_class lengths, measure;
  mpf_class height;                ///< of the plane over vertex 0, exactly 0 where that is on it
  std::vector<double> unit_edges;  ///< rows, each of length 1
};

/// The facets of a hull whose surface has been checked. Thread safe.
class CheckedFacets {
 public:
  explicit CheckedFacets(const Subject& s);

  /// Coordinates of a vertex in units of 2^exponent(), exact except where they underflow.
  const double* at(std::uint32_t v) const { return rows_ + std::size_t{v} * d_; }
  int exponent() const { return exponent_; }
  /// Whether the axes' extents differ so much that doubles in a common unit lose some of them.
  bool wild() const { return wild_; }
  /// What underflow may change an offset by: nothing where axes differ so much that the library
  /// computes planes exactly.
  double offset_underflow() const;

  /// Each component of `normal` within 1/4 of `normal_bound`, `share` within 2^-20 of itself.
  void terms(std::uint32_t simplex, FacetTerms& out) const;
  /// In units of 1.
  WideTerms wide_terms(std::uint32_t simplex) const;
  /// The same as terms() from wide_terms().
  void rounded_terms(const WideTerms& w, FacetTerms& out) const;
  mp_bitcnt_t wide_bits(std::uint32_t simplex) const;

  /// The greatest documented difference of component c of a plane from the exact unit normal.
  double normal_bound(const FacetTerms& t, std::uint32_t simplex, unsigned c) const;
  /// Whether the bound is for each component, by `spread`.
  bool by_component() const { return k_ == 1 || (k_ == d_ && k_ <= 8); }
  /// The greatest documented error of volume and area relative to themselves, however thin the
  /// simplices are. Below 1/2.
  double relative_bound() const { return relative_; }
  double alpha() const { return alpha_; }  ///< per unit of `spread`, else of `lengths`
  double beta() const { return beta_; }    ///< per unit of the normal itself

  static constexpr double unit = 0x1p-53;
  /// Planes and measures of simplices with a smaller share are computed with more bits than
  /// doubles.
  double careful_share() const { return careful_share_; }

 private:
  template <unsigned K, class Real>
  bool by_cofactors(std::uint32_t simplex, FacetTerms& out) const;
  bool quickly(std::uint32_t simplex, FacetTerms& out) const;
  bool orthogonally(std::uint32_t simplex, FacetTerms& out) const;
  class WideCofactors;
  /// Full dimension. `origin`: null if that is on the plane.
  WideTerms exact_cofactors(std::uint32_t simplex, const double* origin) const;
  /// False where more bits would be needed than Gram-Schmidt takes.
  bool wide_cofactors(std::uint32_t simplex, const double* origin, WideTerms& out) const;
  template <unsigned K>
  void fill_spread(const WideTerms& w, FacetTerms& out) const;
  bool in_range(std::uint32_t from, std::uint32_t to) const;

  const Subject& s_;
  const unsigned d_, k_;
  int exponent_ = 0;
  double largest_ = 0;  ///< |coordinate|, as given
  bool wild_ = false;   ///< some axis' extent is below 2^-400 of that
  const double* rows_;
  std::vector<double> scaled_;
  std::vector<std::uint8_t> constant_;  ///< axes orthogonal to the flat
  double alpha_ = 0, beta_ = 0, careful_share_ = 0x1p-13, relative_ = 0.25;
};

}  // namespace cullhull::internal::certify
