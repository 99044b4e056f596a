// Planes in any dimension, one facet at a time.
#pragma once

#include "hull/general/facet_planes.hpp"

namespace cullhull::internal::inline hull {

void facet_planes_any(const PlaneFrame& frame, const std::uint32_t* facets, std::size_t count,
                      float* planes);

}  // namespace cullhull::internal::inline hull
