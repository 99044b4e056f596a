// Frame: the hull's vertices as input of the measures, gathered and scaled.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "cullhull/array.hpp"
#include "cullhull/point_view.hpp"
#include "exact/numbers/exact_float.hpp"
#include "parallel/threads/once.hpp"
#include "result/measures/share.hpp"

namespace cullhull::internal {

struct Run;
/// The coordinates of the hull's vertices, scaled so that products stay within the range of
/// doubles, and the map from the projection on coordinate axes to the flat that the points span.
struct Frame {
  unsigned dimension = 0, k = 0;
  std::vector<unsigned> axes;  // the flat projects onto them one to one
  Array<double> scaled;        // a row for each vertex, in units of 2^exponent
  int exponent = 0;
  bool wild = false;  // coordinates span too many powers of two for scaled doubles
  /// The next three are for flat hulls. `spanning`: k + 1 affinely independent vertices; `basis`: k
  /// orthonormal rows that span the flat; `stretch`: the ratio of a measure in the flat to that of
  /// its projection onto the axes.
  std::vector<std::uint32_t> spanning;
  std::vector<double> basis;
  ExactFloat stretch = 1;

  bool flat() const { return k < dimension; }
  /// The scaled coordinates of the vertex at position v.
  const double* at(std::uint32_t v) const { return scaled.data() + std::size_t{v} * dimension; }
  /// The unscaled coordinates. They are gathered at the first call, since few hulls need them.
  /// Thread-safe.
  const double* raw_at(std::uint32_t v) const;

  const PointView* points = nullptr;
  const std::vector<std::uint64_t>* vertices = nullptr;

 private:
  struct Raw {
    Once gathered;
    std::vector<double> rows;
  };
  std::unique_ptr<Raw> raw_ = std::make_unique<Raw>();
};

/// Makes the frame of a hull of affine dimension k. `axes`: any k coordinate axes onto which the
/// flat projects one to one. For a flat hull the frame chooses axes of its own, onto which the
/// projection shrinks the flat less; they keep its orientation. The frame refers to `points` and
/// `vertices`.
Frame make_frame(const PointView& points, const std::vector<std::uint64_t>& vertices,
                 const unsigned* axes, unsigned k, const Run& run);

/// A frame of which only raw_at() and the sizes may be used.
Frame make_unscaled_frame(const PointView& points, const std::vector<std::uint64_t>& vertices,
                          unsigned k);

}  // namespace cullhull::internal
