// From a polytope to the GaugeMap's table.
#pragma once

#include "cull/gauge_map.hpp"
#include "cull/gauge_table.hpp"

namespace cullhull::internal {

/// Fills `table`; false when no useful map exists. See GaugeMap::build.
bool build_gauge_table(const InnerPolytope& polytope, unsigned resolution, std::uint32_t most_nodes,
                       GaugeTable& table);

}  // namespace cullhull::internal
