// How many facets a hull will have, before it is built.
#pragma once

#include <cstdint>

#include "geometry/local_points.hpp"
#include "parallel/control.hpp"

namespace cullhull::internal {

struct FacetEstimate {
  double vertices = 0, facets = 0;
};

/// The most facets n points can have (McMullen 1970, the upper bound theorem), or infinity.
double most_facets(std::uint64_t n, unsigned d);

/// Facets where all n points are extreme on a smooth body: what a cheap first look assumes.
double smooth_facets(double vertices, unsigned d);

/// Extrapolated from the hulls of small samples and from how many of a few points are extreme.
/// Usually within a factor of 2. Takes tenths of a second; deterministic.
FacetEstimate estimate_facets(const LocalPoints& points, unsigned threads, const Control& control);

/// Throws Error{out_of_budget} with the estimate if the hull is expected to need more than
/// `budget` bytes, at `bytes_per_facet`. Costs nothing where n points cannot need that much on a
/// smooth body.
void check_facets(const LocalPoints& points, std::uint64_t budget, std::uint64_t bytes_per_facet,
                  unsigned threads, const Control& control);

}  // namespace cullhull::internal
