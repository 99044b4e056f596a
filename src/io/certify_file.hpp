// certify_file over bytes in memory.
#pragma once

#include "cullhull/certify.hpp"
#include "io/source.hpp"

namespace cullhull::internal {

Certificate certify_source(const PointView& points, const Source& source, const Options& options,
                           const Grid& grid = {}, std::uint64_t first_id = 0);

}  // namespace cullhull::internal
