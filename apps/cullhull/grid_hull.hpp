// The hull of a scan's integers, read in place, with measures in the units of its grid.
#pragma once

#include "cullhull/hull_fwd.hpp"
#include "cullhull/io.hpp"

namespace app {

/// convex_hull of the points that `numbers`, those of a file with this placement, are on the grid,
/// bit for bit: the filter reads the numbers in place, and what survives is moved to the grid. A
/// hull's extreme points do not depend on scales; its planes and measures do. Errors as
/// convex_hull.
cullhull::Hull hull_on_grid(const cullhull::PointView& numbers,
                            const cullhull::Placement& placement, const cullhull::Grid& grid,
                            const cullhull::Options& options);

}  // namespace app
