// Normal and plane of one simplex, computed with as many bits as it needs.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <type_traits>
#include <vector>

#include "cullhull/error.hpp"
#include "exact/determinants/cofactors.hpp"
#include "exact/numbers/double_double.hpp"
#include "exact/orientation/orientation.hpp"
#include "exact/planes/elimination.hpp"
#include "result/facets/orthogonal_parts.hpp"
#include "result/measures/measure_frame.hpp"
#include "result/measures/share.hpp"

namespace cullhull::internal {

/// The same fraction for dimensions above those of `cofactors`. It also allows for edges in random
/// directions, which are far from orthogonal in high dimensions: the determinant of k random unit
/// vectors is about sqrt(k! / k^k).
inline double conditioned_in(unsigned k) {
  double share = conditioned * conditioned;
  for (unsigned i = 1; i <= k; ++i) share *= static_cast<double>(i) / k;
  return std::sqrt(share);
}

/// a - b: rounded for doubles, exact for double-doubles.
template <class Real>
Real difference(double a, double b) {
  if constexpr (std::is_same_v<Real, double>) return a - b;
  if constexpr (std::is_same_v<Real, DoubleDouble>) return DoubleDouble::sum(a, -b);
}
inline double value(double v) { return v; }
inline double value(const DoubleDouble& v) { return v.value(); }

/// Computes the normal to the k - 1 rows of m, elimination_stride(k) apart, which it overwrites, by
/// elimination with complete pivoting; for dimensions above those of `cofactors`. The normal is 0
/// if the rows are dependent.
template <class Real>
void eliminate_normal(std::vector<Real>& m, unsigned k, Real* normal);
extern template void eliminate_normal(std::vector<double>&, unsigned, double*);
extern template void eliminate_normal(std::vector<DoubleDouble>&, unsigned, DoubleDouble*);

inline double length(const double* v, unsigned n) {
  double square = 0;
  for (unsigned c = 0; c < n; ++c) square += v[c] * v[c];
  return std::sqrt(square);
}

/// Computes the outward cofactor normal of the simplex with vertices v[0 .. k), on the frame's
/// axes. Returns the product of the lengths of its edges from v[0], an upper bound of the normal's
/// length.
template <unsigned K, class Real>
double simplex_normal(const Frame& frame, const std::uint32_t* v, Real* normal,
                      std::vector<Real>& scratch) {
  const unsigned k = K ? K : frame.k;
  const double* origin = frame.at(v[0]);
  double lengths = 1;
  const auto fill = [&](unsigned i, Real* row) {
    const double* p = frame.at(v[i]);
    double square = 0;
    for (unsigned c = 0; c < k; ++c) {
      const unsigned a = frame.axes[c];
      row[c] = difference<Real>(p[a], origin[a]);
      square += value(row[c]) * value(row[c]);
    }
    lengths *= std::sqrt(square);
  };
  if constexpr (K != 0) {
    Real edges[K > 1 ? K - 1 : 1][K];
    for (unsigned i = 1; i < K; ++i) fill(i, edges[i - 1]);
    Real out[K];
    cofactors<K, Real>(edges, out);
    for (unsigned c = 0; c < K; ++c) normal[c] = out[c];
  } else {
    const std::size_t stride = elimination_stride(k);
    scratch.assign((k - 1) * stride, Real(0));
    for (unsigned i = 1; i < k; ++i) fill(i, scratch.data() + (i - 1) * stride);
    eliminate_normal(scratch, k, normal);
  }
  return lengths;
}

/// Computes planes of simplices, which are given by the positions of their vertices and outward
/// oriented.
template <unsigned K>
class FacetPlane {
 public:
  explicit FacetPlane(const Frame& frame)
      : frame_(frame),
        k_(K ? K : frame.k),
        conditioned_(K != 0 ? conditioned : conditioned_in(k_)) {}

  /// Computes the normal in doubles and, if that is ill-conditioned, in double-doubles. Returns its
  /// length. Sets `reliable` to whether the result is accurate enough, and `error` to a bound of
  /// the normal's rounding error, up to a modest constant, in units of 2^-53.
  double normal(const std::uint32_t* v, double* n, std::vector<double>& scratch, bool* reliable,
                double* error) const {
    const double lengths = simplex_normal<K, double>(frame_, v, n, scratch);
    const double l = length(n, k_);
    *reliable = true;
    *error = l;
    if (well_conditioned(l, lengths)) return l;
    return careful_normal(v, lengths, n, reliable, error);
  }

  /// Whether doubles are enough for a normal of this length, as computed in doubles; `lengths`: the
  /// product of the lengths of its edges.
  bool well_conditioned(double length, double lengths) const {
    return length > conditioned_ * lengths;
  }
  /// Judges a normal of this length that was computed in double-doubles, as normal() does.
  void judge_careful(double length, double lengths, bool* reliable, double* error) const {
    *error = length + 0x1p-49 * lengths;
    *reliable = length > 0x1p-40 * conditioned_ * lengths &&
                length > 0x1p-450;  // far from underflow of its square
  }

  /// Writes the plane of simplex v to out[0 .. d], from its normal n, which is overwritten.
  /// Computes an unreliable normal exactly.
  void write(const std::uint32_t* v, double* n, bool reliable, double* out) const {
    const unsigned d = frame_.dimension;
    if (frame_.wild && frame_.flat()) return write_flat(v, out);
    if (!reliable) exact_normal(v, n);
    double largest = 0;
    for (unsigned c = 0; c < k_; ++c) largest = std::max(largest, std::fabs(n[c]));
    if (!(largest > 0x1p-400 && largest < 0x1p400)) {
      const int e = largest > 0 ? std::ilogb(largest) : 0;
      for (unsigned c = 0; c < k_; ++c) n[c] = std::ldexp(n[c], -e);
    }
    if (frame_.flat()) {
      std::fill(out, out + d, 0.0);
      for (unsigned r = 0; r < k_; ++r) {
        const double* row = frame_.basis.data() + std::size_t{r} * d;
        double t = 0;
        for (unsigned c = 0; c < k_; ++c) t += row[frame_.axes[c]] * n[c];
        for (unsigned c = 0; c < d; ++c) out[c] += t * row[c];
      }
    } else {
      std::copy(n, n + k_, out);
    }
    const double l = length(out, d);
    const double* p = frame_.at(v[0]);
    double offset = 0;
    for (unsigned c = 0; c < d; ++c) {
      out[c] /= l;
      offset -= out[c] * p[c];
    }
    out[d] = frame_.wild ? wide_offset(v, out) : scale_by(offset, frame_.exponent);
  }

 private:
  double careful_normal(const std::uint32_t* v, double lengths, double* n, bool* reliable,
                        double* error) const {
    DoubleDouble few[K ? K : 1];
    std::vector<DoubleDouble> many(K ? 0 : k_), scratch;
    DoubleDouble* wide = K ? few : many.data();
    simplex_normal<K, DoubleDouble>(frame_, v, wide, scratch);
    for (unsigned c = 0; c < k_; ++c) n[c] = wide[c].value();
    const double l = length(n, k_);
    judge_careful(l, lengths, reliable, error);
    return l;
  }

  double wide_offset(const std::uint32_t* v, const double* normal) const {
    ExactFloat offset;
    for (unsigned c = 0; c < frame_.dimension; ++c)
      offset = offset - ExactFloat(normal[c]) * ExactFloat(frame_.raw_at(v[0])[c]);
    return offset.to_double();
  }

  /// Writes the plane of a facet of a flat hull exactly: the normal is the direction in the flat
  /// that is orthogonal to the facet and points away from a vertex off it.
  void write_flat(const std::uint32_t* v, double* out) const {
    std::vector<const double*> corners;
    for (unsigned j = 0; j < k_; ++j) corners.push_back(frame_.raw_at(v[j]));
    corners.push_back(nullptr);
    for (const std::uint32_t apex : frame_.spanning) {
      corners[k_] = frame_.raw_at(apex);
      const std::vector<RoundedFloat> inward =
          ExactOrthogonalParts(frame_.dimension, corners.data(), k_).direction(k_ - 1);
      if (inward.empty()) continue;
      for (unsigned c = 0; c < frame_.dimension; ++c) out[c] = (-inward[c]).to_double();
      out[frame_.dimension] = wide_offset(v, out);
      return;
    }
    throw Error(ErrorCode::internal, "a facet of the hull contains all of it");
  }

  void exact_normal(const std::uint32_t* v, double* n) const {
    std::vector<double> packed;
    for (unsigned j = 0; j < k_; ++j)
      for (unsigned c = 0; c < k_; ++c) packed.push_back(frame_.raw_at(v[j])[frame_.axes[c]]);
    std::vector<const double*> rows;
    for (unsigned j = 0; j < k_; ++j) rows.push_back(packed.data() + std::size_t{j} * k_);
    if (!plane_exact(k_, rows.data(), n))
      throw Error(ErrorCode::internal, "a simplex of the hull is degenerate");
  }

  const Frame& frame_;
  const unsigned k_;
  const double conditioned_;
};

/// Eight simplices of K corners in R^K, one a lane, for facet_block. Input: `corner` and `origin`;
/// output: the other fields.
template <unsigned K>
struct FacetBlock {
  static constexpr unsigned lanes = 8;
  alignas(64) double corner[K][K][lanes];  ///< indices: corner, coordinate, lane
  alignas(64) double origin[K][lanes];     ///< the point that sums refer to
  /// The normals, with the bits that `cofactors` computes.
  alignas(64) double normal[K][lanes];
  /// Sum over the corners of their differences from the origin.
  alignas(64) double sum[K][lanes];
  alignas(64) double length[lanes];  ///< length of the normal
  alignas(64) double edges[lanes];   ///< product of the lengths of the edges from corner 0
  alignas(64) double reach[lanes];   ///< product of those edges' largest absolute coordinates
  // By facet_shares:
  alignas(64) double largest[lanes];  ///< largest absolute coordinate of the normal
  alignas(64) double volume[lanes];   ///< FacetMoments
  alignas(64) double moment[K][lanes];
  alignas(64) double span[lanes];          ///< the `reach` of FacetMoments
  alignas(64) double plane[K + 1][lanes];  ///< unit normal and offset, in the corners' units
};

/// Fills the outputs of a block down to `reach`, for K from 3 to 8. Every instruction set performs
/// the same IEEE operations, so all give the same bits.
template <unsigned K>
void facet_block(FacetBlock<K>& block);
/// Fills the others after facet_block, for K from 4 to 8.
template <unsigned K>
void facet_shares(FacetBlock<K>& block);

}  // namespace cullhull::internal
