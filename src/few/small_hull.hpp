// Single calls with few points: from points to the result on the calling thread, bypassing the
// general flow.
#pragma once

#include <cstdint>
#include <vector>

#include "cullhull/batch.hpp"
#include "cullhull/extreme_points.hpp"
#include "cullhull/hull.hpp"
#include "cullhull/options.hpp"
#include "cullhull/point_view.hpp"
#include "few/small_3d.hpp"

namespace cullhull::internal {

/// More bytes than a small set of this dimension takes, result included, so that these paths need
/// not count bytes.
constexpr std::uint64_t small_set_bytes(std::uint32_t dimension) {
  return dimension <= 3 ? std::uint64_t{1} << 22 : std::uint64_t{1} << 23;
}

/// Whether the options permit these direct paths: not where the caller chose a filter,
/// a device or a memory budget below small_set_bytes().
bool takes_small_sets(const Options& options, std::uint32_t dimension);

/// Fills all of `hull` with the same bits as the general flow. Returns false, having done nothing,
/// where the general flow is needed. `points` and `options` have been checked.
bool small_hull(const PointView& points, const Options& options, Hull& hull);

/// The same for the extreme points alone, in the plane, where nothing else is computed, and in
/// space. From 4D on linear programs find them sooner.
bool small_extreme(const PointView& points, const Options& options, ExtremePoints& result);

// The canonical hull of few points in space and from 4D to 8D, straight from their coordinates.

/// Loads the coordinates of `count` points of the view, those with the given ids; nullptr: the
/// first.
void load_small(const PointView& view, const std::uint64_t* ids, unsigned count,
                SmallPoints3D& points);
void load_small(const PointView& view, const std::uint64_t* ids, unsigned count,
                MediumPoints3D& points);

/// The largest set in space that is hulled without a filter. All its points may be extreme: each is
/// tested against all of up to twice as many facets. With more points the engine's search for a
/// visible facet is faster.
inline constexpr std::uint64_t most_unfiltered_in_space = 1024;

/// The hull of the points with the given ids, which ascend (nullptr: of all points), where they are
/// few: the same bits as build_hull gives. Fills every field except statistics. False, with `hull`
/// unchanged, for points that are too many or not in space or 4D to 8D, for flats, coordinates that
/// span too many powers of two, in space where they are not finite or many signs or a measure need
/// more than doubles, from 4D on where some point lies in the plane of a facet that the insertion
/// tests it against, or where SmallSurface gives up. There points that are not finite throw
/// Error{not_finite}.
bool hull_of_few(const PointView& view, const std::uint64_t* ids, std::uint64_t count, Hull& hull);
/// Appends the hull of a small set of points in space to `to`: the same bits as convex_hull gives.
/// False, with `to` unchanged, for sets that are not small or that small_hull_3d refuses, and where
/// a measure needs more than doubles.
bool append_small_3d(const PointView& set, HullBatch& to);
/// The same for a set whose `count` simplices are known: three positions in `rows` each, in the
/// order of a result. Writes positions among its vertices, `rows`, instead of ids.
bool append_simplices_3d(const PointView& rows, const std::uint8_t* simplices, unsigned count,
                         HullBatch& to);
/// hull_of_few from 4D on.
bool hull_of_few_nd(const PointView& view, const std::uint64_t* ids, std::uint64_t count,
                    Hull& hull);

}  // namespace cullhull::internal
