// Single calls with few points: from points to the result on the calling thread, bypassing the
// general flow.
#pragma once

#include <cstdint>

#include "cullhull/hull.hpp"
#include "cullhull/options.hpp"
#include "cullhull/point_view.hpp"
#include "few/small_3d.hpp"

namespace cullhull::internal::inline few {

/// Whether the options permit it: a chosen filter, engine or device is respected.
bool takes_small_sets(const Options& options);

/// Fills all of `hull`, the same bits as the general flow gives. False, and nothing done, where the
/// general flow is needed. `points` and `options` have been checked.
bool small_hull(const PointView& points, const Options& options, Hull& hull);

// The canonical hull of few points in space, straight from their coordinates.

/// Loads the coordinates of `count` points of the view, those with the given ids; nullptr: the
/// first.
void load_small(const PointView& view, const std::uint64_t* ids, unsigned count,
                SmallPoints3D& points);
void load_small(const PointView& view, const std::uint64_t* ids, unsigned count,
                MediumPoints3D& points);

/// Limit for sets where no filter is used, so that all points may be extreme: each point is tested
/// against all of up to twice as many facets. With more points the engine's search for a visible
/// facet is faster.
inline constexpr std::uint64_t most_unfiltered_in_space = 1024;

/// The hull of the points with the given ids, which ascend (nullptr: of all points), where they are
/// few: the same bits as build_hull gives. Fills every field except statistics. False, with `hull`
/// unchanged, for points that are too many or not in space, for flats, coordinates that are not
/// finite or span too many powers of two, and where many signs or a measure need more than doubles.
bool hull_of_few(const PointView& view, const std::uint64_t* ids, std::uint64_t count, Hull& hull);

}  // namespace cullhull::internal::inline few
