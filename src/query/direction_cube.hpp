// Cells of directions: a grid on the faces of the cube around the origin.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "parallel/threads/parallel.hpp"

namespace cullhull::internal {

class DirectionCube {
 public:
  DirectionCube() = default;
  /// About `cells` cells in R^k; none (empty()) where there would be fewer than two along an edge.
  DirectionCube(unsigned k, double cells) : k_(k) {
    if (k < 2) return;
    const double r = std::pow(cells / (2.0 * k), 1.0 / (k - 1));
    resolution_ = r < 2 ? 0 : static_cast<unsigned>(r);
    per_face_ = 1;
    for (unsigned j = 1; j < k; ++j) per_face_ *= resolution_;
  }
  bool empty() const { return resolution_ == 0; }
  std::size_t size() const { return 2 * k_ * per_face_; }
  unsigned resolution() const { return resolution_; }
  /// Half the width of a cell along each grid axis, on the faces of [-1, 1]^k.
  double half_width() const { return 1.0 / resolution_; }
  /// The axis of the face that holds the cell.
  unsigned axis(std::size_t cell) const { return static_cast<unsigned>(cell / per_face_ / 2); }

  /// Face 2 j + (x_j < 0), then row-major on the other axes. For any x; the zero vector gets an
  /// arbitrary cell.
  std::size_t cell(const double* x) const {
    unsigned axis = 0;
    for (unsigned j = 1; j < k_; ++j)
      if (std::fabs(x[j]) > std::fabs(x[axis])) axis = j;
    const double half = 0.5 * resolution_, scale = half / std::fabs(x[axis]);
    std::size_t cell = 2 * axis + (x[axis] < 0);
    for (unsigned j = 0; j < k_; ++j) {
      if (j == axis) continue;
      // Comparisons in this order: a NaN (0 times infinity) becomes 0.
      const double at = x[j] * scale + half;
      const double top = resolution_ - 1.0;
      cell = cell * resolution_ + static_cast<std::size_t>(at > 0 ? std::min(at, top) : 0.0);
    }
    return cell;
  }

  void centre(std::size_t cell, double* x) const {
    const std::size_t face = cell / per_face_;
    const auto axis = static_cast<unsigned>(face / 2);
    x[axis] = face % 2 ? -1 : 1;
    std::size_t rest = cell % per_face_;
    for (unsigned j = k_; j-- > 0;) {
      if (j == axis) continue;
      x[j] = (2.0 * static_cast<double>(rest % resolution_) + 1) / resolution_ - 1;
      rest /= resolution_;
    }
  }

  /// Returns for each cell the result of search(the previous cell's result, the cell's centre).
  /// Such a search is short, because it starts nearby.
  template <class Search>
  std::vector<std::uint32_t> answers(const Control& control, const Search& search) const {
    std::vector<std::uint32_t> found(size());
    std::vector<double> x(k_);
    std::uint32_t last = 0;
    for (std::size_t i = 0; i < found.size(); ++i) {
      if (i % 1024 == 0) control.check();
      centre(i, x.data());
      found[i] = last = search(last, x.data());
    }
    return found;
  }

 private:
  unsigned k_ = 0, resolution_ = 0;
  std::size_t per_face_ = 0;
};

}  // namespace cullhull::internal
