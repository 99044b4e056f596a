// The hull's vertices as input of the measures: gathered and scaled, with the map from the
// projection to the flat.
#pragma once

#include <bit>
#include <cmath>
#include <cstdint>
#include <memory>
#include <mutex>
#include <vector>

#include "cullhull/array.hpp"
#include "cullhull/point_view.hpp"
#include "exact/numbers/exact_float.hpp"
#include "parallel/threads/run.hpp"

namespace cullhull::internal::inline result {

/// v * 2^e; a multiplication where 2^e is a normal double.
inline double scale_by(double v, int e) {
  return e > -1022 && e < 1023
             ? v * std::bit_cast<double>(static_cast<std::uint64_t>(e + 1023) << 52)
             : std::ldexp(v, e);
}

/// The hull's vertices, in units that keep products within the doubles' range, and the map from
/// the coordinate axes of the projection to the flat.
struct Frame {
  unsigned dimension = 0, k = 0;
  std::vector<unsigned> axes;  // on which the flat projects one to one
  Array<double> scaled;        // vertices x dimension, in units of 2^exponent
  int exponent = 0;
  bool wild = false;  // spans too many powers of two for scaled doubles
  /// Flat hulls: k + 1 affinely independent vertices, k orthonormal rows that span the flat, and
  /// its measure over that of its projection.
  std::vector<std::uint32_t> spanning;
  std::vector<double> basis;
  ExactFloat stretch = 1;

  bool flat() const { return k < dimension; }
  const double* at(std::uint32_t v) const { return scaled.data() + std::size_t{v} * dimension; }
  /// The unscaled coordinates. Gathered at the first call, as few hulls need them.
  const double* raw_at(std::uint32_t v) const;

  const PointView* points = nullptr;
  const std::vector<std::uint64_t>* vertices = nullptr;

 private:
  struct Raw {
    std::once_flag gathered;
    std::vector<double> rows;
  };
  std::unique_ptr<Raw> raw_ = std::make_unique<Raw>();
};

/// `axes`: any k coordinate axes on which the flat projects one to one. The frame's own axes keep
/// the orientation of the projection, but are chosen so that it shrinks the flat little. The frame
/// refers to `points` and `vertices`.
Frame make_frame(const PointView& points, const std::vector<std::uint64_t>& vertices,
                 const unsigned* axes, unsigned k, const Run& run);

}  // namespace cullhull::internal::inline result
