// The extreme points of an engine's boundary.
#pragma once

#include <cstdint>
#include <vector>

#include "hull/engine.hpp"
#include "parallel/threads/run.hpp"

namespace cullhull::internal::inline result {

/// Ascending rows of the extreme points (of equal points the lowest); `boundary` as build_hull
/// takes it. Adds to `rung_counts`.
std::vector<std::uint64_t> extreme_rows(Boundary&& boundary, const LocalPoints& points,
                                        const Run& run, std::uint64_t* rung_counts);

/// Ascending rows of a polygon's corners among `count` rows, or their ids (which ascend) if not
/// null.
std::vector<std::uint64_t> ascending_ids(const std::uint32_t* corners, std::size_t size,
                                         std::uint32_t count, const std::uint64_t* ids,
                                         const Run& run);

}  // namespace cullhull::internal::inline result
