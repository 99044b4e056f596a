// Estimates the number of facets of a hull before it is built.
#pragma once

#include <cstdint>

#include "exact/points/local_points.hpp"

namespace cullhull::internal {

struct Run;
struct FacetEstimate {
  double vertices = 0, facets = 0;
};

/// The most facets n points can have (McMullen 1970, the upper bound theorem), or infinity.
double most_facets(std::uint64_t n, unsigned d);

/// Facets of a hull whose points are all extreme, on a smooth body, as on large spheres: a first,
/// cheap estimate.
double smooth_facets(double vertices, unsigned d);

/// Extrapolates from the hulls of small samples and from the share of tested points that are
/// extreme. Usually within a factor of 2. Takes tenths of a second; deterministic.
FacetEstimate estimate_facets(const LocalPoints& points, const Run& run);

/// Throws Error{out_of_budget} with the estimate if the hull is expected to need more than
/// run.budget bytes, at `bytes_per_facet`. Returns at once where that many points on a smooth body
/// would need less.
void check_facets(const LocalPoints& points, std::uint64_t bytes_per_facet, const Run& run);

}  // namespace cullhull::internal
