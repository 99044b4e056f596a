// Graphs that join nearby points, from their Delaunay triangulation.
#pragma once

#include <cstdint>

#include "cullhull/array.hpp"
#include "cullhull/options.hpp"
#include "cullhull/point_view.hpp"
#include "cullhull/triangulation.hpp"

#pragma GCC visibility push(default)
namespace cullhull {

/// Each graph is a list of edges x 2 ids, the lower one first, sorted lexicographically.
/// `triangulation`: delaunay() of `points`, in any dimension. Lengths are compared exactly: no
/// graph depends on the order of work, and only ties of the spanning tree depend on ids. Each of
/// these graphs contains the one before it, except for duplicates: minimum spanning tree, relative
/// neighbourhood graph, Gabriel graph, Delaunay triangulation.
///
/// Options used: threads, stop, progress. Errors: invalid_argument if the points are not those of
/// the triangulation, for furthest-site triangulations and for hidden points; cancelled. Thread
/// safe.
/// Source: docs/exactness.md, "Proximity graphs".

/// The Euclidean minimum spanning tree; of several, the one that takes edges in order of length,
/// then lower id, then higher id (Kruskal). It spans all points: duplicates are joined to their
/// representative, the one with the lowest id, by edges of length zero. Time O(edges log edges).
Array<std::uint32_t> minimum_spanning_tree(const PointView& points,
                                           const Triangulation& triangulation,
                                           const RunOptions& options = {});

/// p and q are joined if no third point is in the closed ball whose diameter is pq (Gabriel and
/// Sokal 1969). Of equal points only the one with the lowest id has edges. Time O(cells k^3).
Array<std::uint32_t> gabriel_graph(const PointView& points, const Triangulation& triangulation,
                                   const RunOptions& options = {});

/// p and q are joined if no third point is nearer to both than they are to each other (Toussaint
/// 1980). Of equal points only the one with the lowest id has edges. Time: that of the Gabriel
/// graph; besides, each of its edges tests the points that are nearer to one end than the other end
/// is, for the end with fewer of them: a few for most sets.
Array<std::uint32_t> relative_neighbourhood_graph(const PointView& points,
                                                  const Triangulation& triangulation,
                                                  const RunOptions& options = {});

}  // namespace cullhull
#pragma GCC visibility pop
