// A layout of points for finding the least one along a direction.
#pragma once

#include <cstdint>
#include <vector>

#include "exact/points/local_points.hpp"
#include "parallel/index.hpp"
#include "parallel/threads/parallel.hpp"

namespace cullhull::internal {

/// Coordinates rounded to f32, column by column in blocks, each block with its bounding box: a scan
/// skips blocks whose box is not low enough. Boxes are small if consecutive points are near one
/// another.
class PointColumns {
 public:
  static constexpr unsigned block = 64;      ///< points
  static constexpr unsigned box_group = 16;  ///< boxes

  explicit PointColumns(const LocalPoints& points);
  PointColumns(const LocalPoints& points, const std::vector<std::uint32_t>& ids,
               const Control& control);
  void add(std::uint32_t id);

  const std::vector<std::uint32_t>& ids() const { return ids_; }
  bool contains(std::uint32_t id) const { return slot_[id] != no_index; }

  struct Least {
    std::uint32_t id = no_index;  ///< no_index: there is no other point
    float value = 0;
  };
  /// Returns the least direction . x of the first `count` points (a multiple of `block`, or all)
  /// without point `except`, computed in f32: within (d + 2) 2^-24 sum |direction_j| + 2^-120 of
  /// exact if all |x_j| <= 1.
  Least least(const float* direction, std::uint32_t except, std::size_t count = no_index) const;

 private:
  const LocalPoints& points_;
  std::vector<std::uint32_t> ids_, slot_;
  /// Coordinate j of point k of block b: columns_[(b d + j) 64 + k]; of box k of group g: low_[(g d
  /// + j) 16 + k]. Padding is NaN.
  std::vector<float> columns_, low_, high_;
};

}  // namespace cullhull::internal
