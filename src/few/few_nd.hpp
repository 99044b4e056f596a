// The canonical hull of few points in four to eight dimensions, from their coordinates.
#pragma once

#include <cstdint>

#include "cullhull/hull_fwd.hpp"
#include "cullhull/point_view.hpp"

namespace cullhull::internal {

/// Does hull_of_few() from 4D on.
bool hull_of_few_nd(const PointView& view, const std::uint64_t* ids, std::uint64_t count,
                    Hull& hull);

}  // namespace cullhull::internal
