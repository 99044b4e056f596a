// The pseudo-hull filter on a CUDA device, for points in its memory. Only in builds with CUDA.
#pragma once

#include <cstdint>
#include <vector>

#include "cuda/gauge.hpp"
#include "cullhull/device_points.hpp"
#include "filter/pseudo_hull/pseudo_hull.hpp"
#include "parallel/threads/parallel.hpp"

namespace cullhull::internal {

inline constexpr unsigned pseudo_hull_cuda_max_dimension = 6;

/// The same as pseudo_hull_survivors on the device; the same settings give the same result, except
/// that 0 subsets means as few as the greatest size of a subset and the device's memory allow,
/// since all multiprocessors work on one subset at a time. For 2 to 6 dimensions. Needs 33 bytes of
/// device memory for each point of a subset, and memory for the facets. Throws OutOfMemory if
/// there is less, and Failure if the device fails.
std::vector<std::uint64_t> pseudo_hull_survivors_cuda(
    const DevicePointView& points, const PseudoHullSettings& settings, const Control& control,
    std::vector<PseudoHullRound>* rounds = nullptr);

/// The same with a single subset, of at most 2^28 points. The ids stay in the device's memory; the
/// work is on points.stream.
DeviceIds pseudo_hull_survivors_there(const DevicePointView& points, unsigned max_rounds,
                                      const Control& control);

}  // namespace cullhull::internal
