// Checks whether vertices of merged cells are corners of them.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>

#include "cullhull/triangulation.hpp"
#include "parallel/threads/run.hpp"

namespace cullhull::internal::certify {

/// The merged cells of a group are a convex polytope in the flat. A vertex is a corner of it if and
/// only if the normals of the polytope's facets at the vertex have full rank. A vertex is a corner
/// of one of its groups if and only if it is a corner of all: then its lifted point is a vertex of
/// the lower hull.
class GroupCorners {
 public:
  GroupCorners(const Triangulation& t, std::function<const double*(std::uint32_t)> row)
      : t_(t), row_(std::move(row)) {}
  /// The lowest id of a vertex that is not a corner; uses rational arithmetic for each vertex of
  /// merged cells.
  std::optional<std::uint32_t> first_that_is_none(const Run& run) const;

 private:
  bool corner(std::uint32_t v, const std::vector<std::uint32_t>& cells) const;

  const Triangulation& t_;
  std::function<const double*(std::uint32_t)> row_;
};

}  // namespace cullhull::internal::certify
