// PseudoHull on a CUDA device, over points in its memory. Built only with CUDA.
#pragma once

#include <cstdint>
#include <vector>

#include "cuda/gauge.hpp"
#include "cullhull/device_points.hpp"
#include "filter/pseudo_hull/pseudo_hull.hpp"
#include "parallel/threads/parallel.hpp"

namespace cullhull::internal::inline cuda {

inline constexpr unsigned pseudo_hull_cuda_max_dimension = 6;

/// As pseudo_hull_survivors, with the same result for the same settings, except that 0 subsets
/// means as few as their greatest size and the device's memory allow: all multiprocessors work on
/// one subset at a time. 2 to 6 dimensions. Device memory: 33 bytes a point of a subset, and the
/// facets. Throws cuda::OutOfMemory where that is not available, cuda::Failure where the device
/// fails.
std::vector<std::uint64_t> pseudo_hull_survivors_cuda(
    const DevicePointView& points, const PseudoHullSettings& settings, const Control& control,
    std::vector<PseudoHullRound>* rounds = nullptr);

/// The same with a single subset; the ids stay on the device, on points.stream.
cuda::DeviceIds pseudo_hull_survivors_there(const DevicePointView& points, unsigned max_rounds,
                                            const Control& control,
                                            std::vector<PseudoHullRound>* rounds = nullptr);

}  // namespace cullhull::internal::inline cuda
