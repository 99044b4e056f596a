// The filter stage of the pipeline: a sample's exact hull becomes the map that culls the rest.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "cullhull/array.hpp"
#include "cullhull/cull.hpp"
#include "filter/gauge/gauge_map.hpp"
#include "parallel/threads/run.hpp"

namespace cullhull::internal::inline flow {

/// The survivors of an input, with their coordinates where those have been gathered.
struct Filtered {
  Survivors survivors;
  Array<double> rows;                ///< packed rows of the survivors; empty: not gathered yet
  std::uint64_t pass_survivors = 0;  ///< how many the pass over the whole input left
};

/// Up to so many points in space the filter is a map of the outermost points, which takes little
/// more than a pass. With more points a larger sample and a finer map pay.
inline constexpr std::uint64_t most_by_outermost = 1 << 16;

/// Runs the filter the options ask for. Points that are not finite always survive, so that
/// gathering the survivors reports them; `rows` has been checked. A sample whose hull would exceed
/// the budget gives no map; survivors that exceed it are Error{out_of_budget}.
Filtered run_filter(const PointView& points, const Run& run);

/// The same by the map of a given polytope, whose vertices are points of a larger set: a dropped
/// point lies strictly inside it. Keeps all points where there is no map.
Filtered filter_by(InnerPolytope polytope, const PointView& points, const Run& run);

/// Why the gauge map is not tried; empty if it is.
std::string why_no_filter(CullMethod method, std::uint64_t count, unsigned d);

/// Culls the survivors of a first map, whose rows have been gathered, by a second map if it pays.
void refine_survivors(Filtered& result, unsigned d, const Run& run);

/// Gathers the coordinates of the survivors of a first pass unless that was done. Throws
/// Error{not_finite} for the first bad point.
void gather_survivors(const PointView& points, Filtered& result, const Run& run);

/// Keeps of the survivors those at the given positions. `rows`: their rows, where gathered.
void keep_of_survivors(Filtered& result, unsigned d, const std::vector<std::uint64_t>& kept,
                       Array<double>&& rows = {});

}  // namespace cullhull::internal::inline flow
