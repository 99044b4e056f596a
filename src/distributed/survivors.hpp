// The filter of one rank.
#pragma once

#include "cullhull/mpi.hpp"
#include "stream/numbered_points.hpp"

namespace cullhull::internal::inline distributed {

/// The points of a block that are not provably strictly inside the hull of `common` (points of all
/// ranks) or of the block itself. Error{not_finite} names the first bad point by its id.
NumberedPoints survivors_of(const NumberedPoints& common, const mpi::Block& block,
                            const Options& options);

}  // namespace cullhull::internal::inline distributed
