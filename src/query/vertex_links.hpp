// The simplices and the other vertices around each vertex of a hull.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "cullhull/hull.hpp"
#include "parallel/adjacency.hpp"

namespace cullhull::internal {

/// `hull`: its `count` vertices are numbered 0, 1, ...; it must outlive this object. Time and
/// memory: O(simplices).
class VertexLinks {
 public:
  VertexLinks(const Hull& hull, std::size_t count)
      : corners_(hull.simplices),
        width_(static_cast<std::size_t>(hull.affine_dimension)),
        simplices_(rows_by_id(corners_, width_, count)) {}

  std::span<const std::uint32_t> simplices(std::uint32_t v) const { return simplices_[v]; }

  /// The other vertices of the simplices around v, ascending.
  void neighbours(std::uint32_t v, std::vector<std::uint32_t>& out) const {
    out.clear();
    for (const std::uint32_t s : simplices(v))
      for (std::size_t j = 0; j < width_; ++j)
        if (corners_[s * width_ + j] != v)
          out.push_back(static_cast<std::uint32_t>(corners_[s * width_ + j]));
    std::sort(out.begin(), out.end());
    out.erase(std::unique(out.begin(), out.end()), out.end());
  }

 private:
  std::span<const std::uint64_t> corners_;
  std::size_t width_;
  Adjacency<std::uint32_t> simplices_;  ///< by vertex
};

}  // namespace cullhull::internal
