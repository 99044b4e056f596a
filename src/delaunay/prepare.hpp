// From a view and weights to what the engine works on: order, equal points, the flat, scaling.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "cullhull/triangulation.hpp"
#include "exact/points/lifted_points.hpp"
#include "parallel/threads/run.hpp"

namespace cullhull::internal {

struct Prepared {
  LiftedPoints points;
  std::vector<std::uint32_t> simplex;  ///< affine dimension + 1 independent points, by place
  std::vector<std::uint32_t> axes;     ///< those the flat projects onto one to one
  std::vector<DuplicatePoint> duplicates;
};

/// `left_out`: ids, ascending, to do without; duplicates are told all the same.
Prepared prepare_points(const PointView& view, std::span<const double> weights, bool furthest,
                        const std::vector<std::uint32_t>& left_out, const Run& run);

}  // namespace cullhull::internal
