// Keys of points along a Hilbert curve through a box.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "geometry/box_of_rows.hpp"

namespace cullhull::internal {

// Positions of points along a Hilbert curve, a block of points at a time.

/// Points per call.
inline constexpr std::size_t curve_block = 16;

/// Sets keys[k] to point k's position on a d-dimensional Hilbert curve (Skilling 2004). Point k has
/// the cell cells[j * curve_block + k] < 2^bits along axis j < d, d * bits <= 32. Overwrites
/// `cells`. Time: about 5 ns a point for 8 bits in 4D.
void curve_keys(unsigned d, unsigned bits, std::uint32_t* cells, std::uint32_t* keys);

/// A cube for keys: its low corner is that of some rows' bounding box, its side the box's longest;
/// axes beyond the first 32 are ignored. It uses halves of coordinates, so that no difference
/// overflows. Keys of equal points are equal, those of the ends of the widest axis differ, and
/// points outside have the keys of the cube's nearest points.
class CurveFrame {
 public:
  CurveFrame() = default;
  /// Makes a frame for rows of k numbers.
  explicit CurveFrame(unsigned k)
      : axes_(std::min(k, 32U)),
        bits_(k == 0   ? 0
              : k == 1 ? 31
                       : std::max(1U, 32 / k)) {}

  unsigned key_bits() const { return axes_ * bits_; }

  /// Finds the box of n rows, all finite: row(i) is the address of row i. Returns false, and all
  /// keys are 0, if the box is a point, or too small for keys.
  template <class Row>
  bool measure(std::uint32_t n, const Row& row, const Run& run) {
    low_.assign(axes_, 0);
    widest_ = 0;
    if (n == 0) return false;
    const BoxOfRows box = box_of_rows(n, axes_, row, run);
    for (unsigned j = 0; j < axes_; ++j) {
      low_[j] = box.low[j] * 0.5;
      widest_ = std::max(widest_, box.high[j] * 0.5 - low_[j]);
    }
    return widest_ > 0;
  }

  /// Computes the keys of n rows and calls put(i, key). D: the number of axes if known at compile
  /// time, else 0.
  template <unsigned D = 0, class Row, class Put>
  void keys(std::uint64_t n, const Row& row, const Put& put) const {
    if (!(widest_ > 0)) {
      for (std::uint64_t i = 0; i < n; ++i) put(i, 0U);
      return;
    }
    const unsigned axes = D ? D : axes_;
    const double across = std::ldexp(1.0, static_cast<int>(bits_)), top = across - 1;
    std::uint32_t cells[(D ? D : 32) * curve_block] = {}, keys[curve_block];
    for (std::uint64_t begin = 0; begin < n; begin += curve_block) {
      const auto count = static_cast<unsigned>(std::min<std::uint64_t>(n - begin, curve_block));
      for (unsigned i = 0; i < count; ++i)
        for (unsigned j = 0; j < axes; ++j) {
          const double share = (row(begin + i)[j] * 0.5 - low_[j]) / widest_;
          cells[j * curve_block + i] =
              static_cast<std::uint32_t>(std::clamp(share * across, 0.0, top));
        }
      if (axes > 1) curve_keys(axes, bits_, cells, keys);
      for (unsigned i = 0; i < count; ++i) put(begin + i, axes > 1 ? keys[i] : cells[i]);
    }
  }
  std::uint32_t key(const double* row) const {
    std::uint32_t found = 0;
    keys(
        1, [&](std::uint64_t) { return row; },
        [&](std::uint64_t, std::uint32_t key) { found = key; });
    return found;
  }

 private:
  unsigned axes_ = 0, bits_ = 0;
  std::vector<double> low_;  ///< halves of the low corner
  double widest_ = 0;        ///< half of the longest side
};

}  // namespace cullhull::internal
