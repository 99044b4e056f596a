// From gathered points to the engines' frame: scaling, flats, and a simplex to start from.
#pragma once

#include <cstdint>
#include <vector>

#include "control.hpp"
#include "points/local_points.hpp"

namespace cullhull::internal {

/// Owns what LocalPoints views.
class LocalFrame {
 public:
  /// `rows`: count x dimension finite doubles; taken over. Finds the affine dimension exactly,
  /// projects onto as many axes as it has (one to one on the flat) and scales.
  /// Time O(n d^2); memory: rows, and a second copy where scaling is not exact or axes are dropped.
  LocalFrame(std::vector<double>&& rows, std::uint32_t count, unsigned dimension,
             const Control& control);

  int affine_dimension() const { return affine_dimension_; }
  /// The axes kept, ascending; as many as the affine dimension.
  const std::vector<unsigned>& axes() const { return axes_; }
  /// affine_dimension() + 1 affinely independent points.
  const std::vector<std::uint32_t>& simplex() const { return simplex_; }
  const LocalPoints& points() const { return points_; }

 private:
  struct Axis {
    double shift = 0;
    int exponent = 0;  // coordinates are multiplied by 2^-exponent
    bool constant = true;
    bool exact = true;
  };
  void measure_axes();
  void scale_rows(std::vector<double>& rows) const;
  void find_simplex(const std::vector<double>& scaled);
  std::uint32_t farthest(const std::vector<double>& scaled, const std::vector<double>& basis,
                         unsigned rank, std::uint32_t stride) const;
  bool independent(std::uint32_t candidate);
  std::uint32_t independent_by_scan();
  void keep_axes(std::vector<double>& rows) const;
  void detect_lattice();

  const Control& control_;
  std::vector<double> raw_, scaled_;
  std::uint32_t count_;
  unsigned dimension_;
  int affine_dimension_ = -1;
  std::vector<Axis> frame_;
  std::vector<unsigned> axes_;
  std::vector<std::uint32_t> simplex_;
  LocalPoints points_;
};

}  // namespace cullhull::internal
