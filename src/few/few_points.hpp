// Single calls with few points: from points to the result on the calling thread, bypassing the
// general flow.
#pragma once

#include <cstdint>

#include "cullhull/extreme_points.hpp"
#include "cullhull/hull_fwd.hpp"
#include "cullhull/options.hpp"
#include "cullhull/point_view.hpp"

namespace cullhull::internal {

/// More bytes than a small set of this dimension takes, result included, so that these paths need
/// not count bytes.
constexpr std::uint64_t small_set_bytes(std::uint32_t dimension) {
  return dimension <= 3 ? std::uint64_t{1} << 22 : std::uint64_t{1} << 23;
}

/// Whether the options permit these direct paths: not where the caller chose a filter, a device or
/// a memory budget below small_set_bytes().
bool takes_small_sets(const Options& options, std::uint32_t dimension);

/// Fills all of `hull` with the same bits as the general flow. Returns false, having done nothing,
/// where the general flow is needed. `points` and `options` have been checked.
bool small_hull(const PointView& points, const Options& options, Hull& hull);

/// The same for the extreme points alone, in the plane, where nothing else is computed, and in
/// space. From 4D on linear programs find them sooner.
bool small_extreme(const PointView& points, const Options& options, ExtremePoints& result);

}  // namespace cullhull::internal
