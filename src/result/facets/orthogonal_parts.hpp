// Measures and normals of simplices of any shape, from exact integers: the orthogonal parts of
// their edges.
#pragma once

#include <vector>

#include "exact/numbers/exact_float.hpp"
#include "exact/numbers/gmpxx.hpp"

namespace cullhull::internal {

/// The orthogonal parts of the edges p[i + 1] - p[0] of affinely independent points p[0], ...,
/// p[rows] in R^d. Rest i is the component of edge i orthogonal to the edges before it. A
/// fraction-free elimination of the edges' Gram matrix yields every rest times a leading minor of
/// that matrix, in integers, so nothing is rounded before the end.
class ExactOrthogonalParts {
 public:
  /// Throws Error{internal} if an edge other than the last depends on the edges before it.
  ExactOrthogonalParts(unsigned d, const double* const* p, unsigned rows);

  /// The measure of the parallelotope spanned by the first `count` edges, rounded once.
  template <class Float = ExactFloat>
  Float measure(unsigned count) const {
    return Float(minors_[count]).root().times_power_of_two(unit_ * static_cast<long>(count));
  }
  /// The unit vector along rest i; empty if the rest is zero.
  std::vector<RoundedFloat> direction(unsigned i) const;

 private:
  const mpz_class* rest(unsigned i) const { return rests_.data() + std::size_t{i} * d_; }
  RoundedFloat rest_length(unsigned i) const;

  unsigned d_;
  long unit_ = 0;                  // integers are multiples of 2^unit_
  std::vector<mpz_class> minors_;  // of the Gram matrix; minors_[0] = 1
  std::vector<mpz_class> rests_;   // rows x d; row i times minors_[i]
};

/// The measures of a facet in full dimension (k = d), from its exact normal. Each axis has a unit
/// of its own, so the integers stay short if the axes differ in magnitude. Gram matrices would
/// double their length.
class ExactNormal {
 public:
  /// The facet has the affinely independent corners p[0], ..., p[d - 1]; p[d] is an apex.
  ExactNormal(unsigned d, const double* const* p);
  const ExactFloat& area() const { return area_; }      ///< area of the facet's parallelotope
  const ExactFloat& volume() const { return volume_; }  ///< volume of it with the apex

 private:
  ExactFloat area_, volume_;
};

}  // namespace cullhull::internal
