// The canonical hull of few points in space, straight from their coordinates.
#pragma once

#include <cstdint>

#include "cullhull/batch.hpp"
#include "cullhull/hull_fwd.hpp"
#include "cullhull/point_view.hpp"
#include "few/small_3d.hpp"

namespace cullhull::internal {

/// Loads the coordinates of `count` points of the view, those with the given ids; nullptr: the
/// first.
void load_small(const PointView& view, const std::uint64_t* ids, unsigned count,
                MediumPoints3D& points);

/// The hull of the points with the given ids, which ascend (nullptr: of all points), where they are
/// few: the same bits as build_hull gives. Fills every field except statistics. False, with `hull`
/// unchanged, for points that are too many or not in space or 4D to 8D, for flats, coordinates that
/// span too many powers of two, in space where they are not finite or many signs or a measure need
/// more than doubles, from 4D on where some point lies in the plane of a facet that the insertion
/// tests it against, or where SmallSurfaceNd gives up. There points that are not finite throw
/// Error{not_finite}.
bool hull_of_few(const PointView& view, const std::uint64_t* ids, std::uint64_t count, Hull& hull);

/// Does this from 4D on, for points that it takes.
bool hull_of_few_nd(const PointView& view, const std::uint64_t* ids, std::uint64_t count,
                    Hull& hull);

/// Appends the hull of a small set of points in space to `to`: the same bits as convex_hull gives.
/// False, with `to` unchanged, for sets that are not small or that small_hull_3d refuses, and where
/// a measure needs more than doubles.
bool append_small_3d(const PointView& set, HullBatch& to);
/// The same for a set whose `count` simplices are known: three positions in `rows` each, in the
/// order of a result. Writes positions among its vertices, `rows`, instead of ids.
bool append_simplices_3d(const PointView& rows, const std::uint8_t* simplices, unsigned count,
                         HullBatch& to);

}  // namespace cullhull::internal
