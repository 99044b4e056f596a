// From gathered points to the engines' frame: scaling, flats, and a simplex to start from.
#pragma once

#include <cstdint>
#include <vector>

#include "cullhull/array.hpp"
#include "exact/points/local_points.hpp"

namespace cullhull::internal {

struct Run;
/// Transforms points into the engines' frame, and owns the memory that LocalPoints views.
class LocalFrame {
 public:
  /// Takes over `rows`: count x dimension finite doubles. Finds the affine dimension exactly,
  /// projects onto as many axes (one to one on the flat) and scales. Time O(n d^2); memory: the
  /// rows, and a second copy if scaling is not exact or axes are dropped.
  LocalFrame(Array<double>&& rows, std::uint32_t count, unsigned dimension, const Run& run);
  /// Does the same for a copy of `rows`, on one thread.
  LocalFrame(const std::vector<double>& rows, std::uint32_t count, unsigned dimension,
             const Run& run)
      : LocalFrame(Array<double>(rows.begin(), rows.end()), count, dimension, run) {}

  int affine_dimension() const { return affine_dimension_; }
  /// The axes kept, ascending; their number is the affine dimension.
  const std::vector<unsigned>& axes() const { return axes_; }
  /// affine_dimension() + 1 affinely independent points.
  const std::vector<std::uint32_t>& simplex() const { return simplex_; }
  /// The simplex's least distance, in doubles, of a vertex from the flat of those before it.
  double thickness() const { return thickness_; }
  const LocalPoints& points() const { return points_; }

 private:
  struct Axis {
    double shift = 0;
    int exponent = 0;  // coordinates are multiplied by 2^-exponent
    bool constant = true;
    bool exact = true;
  };
  /// Calls body(chunk, begin, end) for chunks of rows, on all threads.
  template <class Body>
  void each_chunk(const Run& run, const Body& body) const;
  void measure_axes(const Run& run);
  void find_inexact_axes(const Run& run);
  void scale_rows(Array<double>& rows, const Run& run) const;
  void find_simplex(const Array<double>& scaled, const Run& run);
  std::uint32_t lowest_row(const Array<double>& scaled, const Run& run) const;
  /// Searches the points `among`; nullptr: all points.
  std::uint32_t farthest(const Array<double>& scaled, const std::vector<double>& basis,
                         unsigned rank, const std::vector<std::uint32_t>* among,
                         const Run& run) const;
  bool independent(std::uint32_t candidate);
  std::uint32_t independent_by_scan(const Run& run);
  void keep_axes(Array<double>& rows, const Run& run) const;
  void detect_lattice(const Run& run);

  Array<double> raw_, scaled_;
  std::uint32_t count_;
  unsigned dimension_;
  int affine_dimension_ = -1;
  std::vector<Axis> frame_;
  std::vector<unsigned> axes_;
  std::vector<std::uint32_t> simplex_;
  double thickness_ = 2;
  LocalPoints points_;
};

}  // namespace cullhull::internal
