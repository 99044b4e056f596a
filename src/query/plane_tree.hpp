// The plane with the largest value at a point: for distances from inside.
#pragma once

#include <cstdint>
#include <vector>

#include "parallel/threads/control.hpp"

namespace cullhull::internal::inline query {

/// Planes n . x + o in a tree of bounding boxes of their coefficients; a box bounds the value from
/// above. Finding the nearest facet from inside is no linear program (the cells are those of the
/// medial axis), hence branch and bound.
class PlaneTree {
 public:
  /// `planes`: count x (d + 1), as in Hull::facet_planes; copied.
  PlaneTree(const std::vector<double>& planes, unsigned d, const Control& control);

  /// Index of a plane with the largest value at x, and the value. `start`: a plane to begin with.
  std::uint32_t largest(const double* x, std::uint32_t start, double& value) const;

 private:
  static constexpr std::uint32_t leaf = 8;  // planes: one SIMD register or two; a guess
  struct Node {
    std::uint32_t begin, end, right;  // right child, 0 for a leaf; the left child is the next node
  };
  std::uint32_t grow(std::uint32_t begin, std::uint32_t end, const Control& control);
  double plane_value(std::uint32_t i, const double* x) const;
  double bound(std::uint32_t node, const double* x) const;
  void search(std::uint32_t node, const double* x, std::uint32_t& best, double& value) const;

  unsigned d_;
  std::vector<double> planes_;
  std::vector<std::uint32_t> order_;
  std::vector<Node> nodes_;
  std::vector<double> boxes_;  // nodes x 2 x (d + 1): low, high
};

}  // namespace cullhull::internal::inline query
