// Checks a finished hull and its points as arguments, and gathers the vertices.
#pragma once

#include <cstdint>
#include <vector>

#include "cullhull/hull_fwd.hpp"
#include "cullhull/point_view.hpp"

namespace cullhull::internal {

/// Throws Error{invalid_argument} for a distance that is negative or not finite, and for points
/// that do not include every vertex of the hull.
void check_hull_arguments(const PointView& points, const Hull& hull, double distance);

/// The position of `id` among the ascending `ids`.
std::uint64_t place_of(const std::vector<std::uint64_t>& ids, std::uint64_t id);
/// The coordinates of these points, a row each.
std::vector<double> rows_of(const PointView& points, const std::vector<std::uint64_t>& ids);

/// The same hull over its vertices alone, numbered by their positions among `ids`.
Hull by_place(Hull hull, const std::vector<std::uint64_t>& ids);

/// The power of two that scales the largest magnitude to [1, 2), as far as doubles can represent
/// it.
double power_to_unit(const std::vector<double>& values);

}  // namespace cullhull::internal
