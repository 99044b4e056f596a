// The filter as the pipeline runs it: a sample's exact hull becomes the map that culls the rest.
#pragma once

#include <cstdint>
#include <vector>

#include "cull/gauge_map.hpp"
#include "cullhull/cull.hpp"
#include "run.hpp"

namespace cullhull::internal {

/// Survivors of the whole input, with the coordinates of each when they are at hand already.
struct Filtered {
  Survivors survivors;
  std::vector<double> rows;      ///< packed rows of the survivors; empty: not gathered yet
  std::uint64_t first_pass = 0;  ///< how many the pass over the whole input left
};

/// Runs the filter the options ask for. Points that are not finite always survive, so that the
/// gathering of survivors reports them; `rows` has been checked. A sample whose hull would exceed
/// the budget gives no map; survivors that exceed it are Error{out_of_budget}.
Filtered run_filter(const PointView& points, const Run& run);

// Its parts, for filters that begin otherwise.

/// The exact hull of some input points, as the filter wants it; dimension 0 if they lie in a flat
/// or the hull would exceed the budget.
InnerPolytope inner_polytope(std::vector<double>&& rows, unsigned d, const Run& run);

/// Fetches the coordinates of survivors of a first pass. Throws Error{not_finite} for the first bad
/// point.
void gather_survivors(const PointView& points, Filtered& result, const Run& run);

/// Leaves of the survivors those with the given positions among them.
void keep_of_survivors(Filtered& result, unsigned d, const std::vector<std::uint64_t>& kept);

/// A second pass over survivors that are at hand, with a map from a sample of them, if there are
/// enough of them to be worth it.
void refine_by_sample(Filtered& result, unsigned d, const Run& run);

}  // namespace cullhull::internal
