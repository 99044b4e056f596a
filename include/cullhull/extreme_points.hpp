// The extreme points without the facets, which in high dimensions are too many to build.
#pragma once

#include <cstdint>
#include <vector>

#include "cullhull/hull.hpp"
#include "cullhull/options.hpp"
#include "cullhull/point_view.hpp"

#pragma GCC visibility push(default)
namespace cullhull {

struct ExtremePoints {
  /// The extreme points (of equal points the lowest id), ascending: Hull::vertices, sorted.
  std::vector<std::uint64_t> ids;
  int affine_dimension = -1;  ///< as in Hull
  Statistics statistics;
};

/// The extreme points, exactly. Instead of a hull, a linear program for each point tests it against
/// the others, in floating point with exactly checked certificates, else in rational arithmetic.
/// Meant for dimension 7 and up. For n points of which h are extreme: O(n h) steps of small linear
/// programs, in parallel; memory O(survivors). Points in a flat of dimension 3 or less use the hull
/// engine without writing facets, in 2D in at most half of convex_hull's time. Errors as
/// convex_hull's.
ExtremePoints extreme_points(const PointView& points, const Options& options = {});

}  // namespace cullhull
#pragma GCC visibility pop
