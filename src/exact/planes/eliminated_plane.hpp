// The hyperplane through d points in any dimension, by elimination in doubles, with an error bound
// found afterwards. docs/exactness.md, "Planes by elimination", has the proofs.
#pragma once

#include <cmath>
#include <cstddef>
#include <vector>

#include "exact/numbers/double_double.hpp"
#include "exact/orientation/orientation.hpp"

namespace cullhull::internal {

/// A plane as the vector z with e_c z = 0 for all edges e_c of the facet; one component of z is 1.
/// Edges are differences from p[0]; columns are scaled by powers of two. Not safe to share between
/// threads.
class EliminatedPlane {
 public:
  /// Finds the plane through p[0..d). Returns false if doubles cannot prove that the points are
  /// affinely independent, or d or a coordinate is outside the range of the proof; then `set` must
  /// be called again before any other function. Time: O(d^3). `p` must outlive the plane.
  bool set(unsigned d, const double* const* p);
  /// Returns the sign of orientation(p[0], ..., p[d-1], x) if the bound decides it; zero if the
  /// determinant is a multiple of a unit and smaller than that unit. Else `known` is false. O(d).
  Sign side(const double* x, bool& known) const;

  /// Computes the same plane in double-doubles: O(d^2). Returns false if the refinement fails.
  bool refine();
  /// Like side, with the refined plane.
  Sign refined_side(const double* x, bool& known) const;

  /// The refined plane rounded to doubles, scaled as `normal` and with the bound of `error`.
  double refined_normal(unsigned j) const { return sign_ * refined_[j].value() * scale_[j]; }
  double refined_error(unsigned j) const {
    return (refined_error_[j] + 0x1p-52 * std::abs(refined_[j].value())) * scale_[j];
  }

  /// Returns component j of a normal n in the original axes: n . (x - p[0]) has the sign of the
  /// orientation.
  double normal(unsigned j) const { return sign_ * z_[j] * scale_[j]; }
  /// Returns a bound of |normal(j) - exact|; the two normals agree in the component that is 1 in z.
  double error(unsigned j) const { return error_[j] * scale_[j]; }
  /// The largest scale factor of any axis.
  double largest_scale() const { return largest_scale_; }

 private:
  double& at(unsigned i, unsigned j) { return lu_[i * stride_ + j]; }
  bool scale_columns();
  bool eliminate();
  void solve_back(std::vector<double>& x) const;
  void solve(std::vector<double>& x) const;
  void bound_inverse(std::vector<double>& x) const;
  bool bound_error();
  bool bound_by_comparison();
  bool bound_by_inverses();
  void invert_factors();
  void bound_product();
  bool bound_of_residual(std::vector<double>& x) const;
  double scaled_edge(unsigned i, unsigned j) const;
  double residual(unsigned i, double& bound) const;
  Sign decide(const double* x, double value, double bound, bool& known) const;
  bool below_unit(const double* x, double magnitude) const;

  unsigned d_ = 0;
  std::size_t stride_ = 0;
  const double* const* p_ = nullptr;
  std::vector<double> lu_;  // (d - 1) x d, stride_ apart, rows and columns in pivot order
  std::vector<unsigned> column_, row_;
  std::vector<int> exponent_;  // scale_ = 2^-exponent_ for each axis
  std::vector<double> scale_, z_, error_;
  std::vector<DoubleDouble> refined_;
  std::vector<double> refined_error_;
  std::vector<double> weight_, image_, work_;  // v and h of the proof; scratch
  bool inverted_ = false;                      // whether bound_by_inverses() found the bounds
  std::vector<double> inverse_, product_;      // inverses of L and V, in one matrix; scratch
  double largest_scale_ = 1;
  double sign_ = 1;  // of the determinant of the first d - 1 pivot columns, with the row exchanges
  double determinant_log_ = 0;  // log2 of the pivots' product, rounded up
  double shrink_ = 0;           // theta
};

}  // namespace cullhull::internal
