// Merging of coplanar simplices in 3D.
#pragma once

#include "result/merge.hpp"

namespace cullhull::internal::inline result {

/// As merge_coplanar, for k = 3 and at least one pair.
Facets merge_polygons(Boundary&& surface, const CoplanarPairs& pairs, const Run& run);

}  // namespace cullhull::internal::inline result
