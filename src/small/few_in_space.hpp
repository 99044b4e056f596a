// The canonical hull of few points in space, straight from their coordinates.
#pragma once

#include <cstdint>

#include "cullhull/hull.hpp"
#include "cullhull/point_view.hpp"
#include "small/small_3d.hpp"

namespace cullhull::internal {

/// Coordinates of `count` points of the view, those with the given ids; nullptr: the first.
void load_small(const PointView& view, const std::uint64_t* ids, unsigned count,
                SmallPoints3D& points);
void load_small(const PointView& view, const std::uint64_t* ids, unsigned count,
                MediumPoints3D& points);

/// Points of which none may be inside: every one is held against up to twice as many facets as
/// there are points, and from here on searching for a facet that it sees pays.
inline constexpr std::uint64_t most_unfiltered_in_space = 1024;

/// The hull of the points with the given ids, which ascend (nullptr: of all points), where they are
/// few: the same bits as build_hull gives. Fills every field but statistics. False, with `hull` as
/// it was, for points that are too many or not in space, for flats, coordinates that are not finite
/// or span too many powers of two, and where many signs or a measure need more than doubles.
bool hull_of_few(const PointView& view, const std::uint64_t* ids, std::uint64_t count, Hull& hull);

}  // namespace cullhull::internal
