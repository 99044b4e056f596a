// PseudoHull on a CUDA device, over points in its memory. Built only with CUDA.
#pragma once

#include <cuda_runtime_api.h>

#include <cstdint>
#include <vector>

#include "control.hpp"
#include "cull/pseudo_hull.hpp"
#include "cullhull/point_view.hpp"

namespace cullhull::internal {

inline constexpr unsigned pseudo_hull_cuda_max_dimension = 6;

/// As pseudo_hull_survivors, with the same answer for the same settings, but that 0 subsets means
/// one, or as many as the size of one demands: all processors of the device work on one at a
/// time. `points` are f32 or f64 in the device's memory, in 2 to 6 dimensions, each coordinate
/// aligned as its type demands; what the stream does to them before is waited for. Device memory:
/// 29 bytes a point, and the facets. Throws Error, or std::bad_alloc where the device has not
/// enough memory (more subsets need less).
std::vector<std::uint64_t> pseudo_hull_survivors_cuda(
    const PointView& points, const PseudoHullSettings& settings, cudaStream_t stream,
    const Control& control, std::vector<PseudoHullRound>* rounds = nullptr);

}  // namespace cullhull::internal
