// Orthogonal parts of edges in exact integers: measures and normals of simplices of any shape.
#pragma once

#include <gmpxx.h>

#include <vector>

#include "exact/numbers/exact_float.hpp"

namespace cullhull::internal::inline result {

/// For affinely independent points p[0], ..., p[rows] of R^d and the edges p[i + 1] - p[0]: the
/// rest of each edge, its component orthogonal to the edges before it. One fraction-free
/// elimination of their Gram matrix yields every rest times that matrix's leading minor, in
/// integers, so nothing is rounded before the end.
class ExactOrthogonalParts {
 public:
  /// Only the last edge may depend on those before it; otherwise throws Error{internal}.
  ExactOrthogonalParts(unsigned d, const double* const* p, unsigned rows);

  /// Measure of the parallelotope of the first `count` edges, rounded once.
  ExactFloat measure(unsigned count) const;
  /// Unit vector along rest i; empty where the rest is zero.
  std::vector<ExactFloat> direction(unsigned i) const;

 private:
  const mpz_class* rest(unsigned i) const { return rests_.data() + std::size_t{i} * d_; }
  ExactFloat rest_length(unsigned i) const;

  unsigned d_;
  long unit_ = 0;                  // integers are multiples of 2^unit_
  std::vector<mpz_class> minors_;  // of the Gram matrix; minors_[0] = 1
  std::vector<mpz_class> rests_;   // rows x d; row i times minors_[i]
};

/// The same measures for k = d, from the simplex's normal: each axis keeps its own unit, so the
/// integers stay short where axes differ in magnitude, and Gram matrices would double them.
class ExactNormal {
 public:
  /// The facet p[0], ..., p[d - 1], affinely independent, and an apex p[d].
  ExactNormal(unsigned d, const double* const* p);
  const ExactFloat& area() const { return area_; }      ///< of the facet's parallelotope
  const ExactFloat& volume() const { return volume_; }  ///< with the apex

 private:
  ExactFloat area_, volume_;
};

}  // namespace cullhull::internal::inline result
