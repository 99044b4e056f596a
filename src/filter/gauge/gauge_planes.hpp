// The GaugeMap's table for a polytope in space with few facets: every node is tested against all of
// their planes, which is faster than a walk from cone to cone.
#pragma once

#include <cstdint>

#include "filter/gauge/gauge_map.hpp"
#include "filter/gauge/gauge_table.hpp"

namespace cullhull::internal::inline filter {

/// A facet's plane in the frame of a table: the gauge of y is the largest q . y of all facets;
/// `slack` bounds the rounding, for |y| <= 1.
struct GaugePlanes {
  std::vector<float> q[3], slack;  // padded to multiples of 16 by copies of the last
};

/// The largest q . v + cells slack of all planes for each of `count` directions v of integers up to
/// `cells`.
void largest_gauges(const GaugePlanes& planes, unsigned cells, const float* x, const float* y,
                    const float* z, std::uint32_t count, float* gauges);

/// Fills `table` as build_gauge_table does. The polytope must be an exact hull in space, its facets
/// outward oriented; only they and the vertices are read. False when no useful map exists.
bool build_gauge_by_planes(const InnerPolytope& polytope, unsigned cells, GaugeTable& table);

}  // namespace cullhull::internal::inline filter
