// Prepares the points for insertion: finds their order, duplicates and flat, and scales them.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "cullhull/triangulation.hpp"
#include "exact/points/local_points.hpp"

namespace cullhull::internal {

struct Run;
struct Prepared {
  LiftedPoints points;
  std::vector<std::uint32_t> simplex;  ///< affine dimension + 1 independent points, by place
  std::vector<std::uint32_t> axes;     ///< the flat's projection onto these axes is one to one
  std::vector<DuplicatePoint> duplicates;
};

/// `left_out`: ascending ids that are not triangulated; their duplicates are still reported.
Prepared prepare_points(const PointView& view, std::span<const double> weights, bool furthest,
                        const std::vector<std::uint32_t>& left_out, const Run& run);

}  // namespace cullhull::internal
