// A finished hull and its points as arguments: checked, and the vertices gathered.
#pragma once

#include <cstdint>
#include <vector>

#include "cullhull/hull.hpp"
#include "cullhull/point_view.hpp"

namespace cullhull::internal {

/// Throws Error{invalid_argument} for a distance that is negative or not finite, and for points of
/// which some vertex of the hull is none.
void check_hull_arguments(const PointView& points, const Hull& hull, double distance);

/// The place of an id among them.
std::uint64_t place_of(const std::vector<std::uint64_t>& ids, std::uint64_t id);
/// Their coordinates, a row each.
std::vector<double> rows_of(const PointView& points, const std::vector<std::uint64_t>& ids);

/// The same hull over its vertices alone, numbered by their place among `ids`.
Hull by_place(Hull hull, const std::vector<std::uint64_t>& ids);

/// The power of two that brings the largest of these to [1, 2), as far as a double holds it.
double power_to_unit(const std::vector<double>& values);

}  // namespace cullhull::internal
