// The exact step of a stream: which of the points it holds are extreme.
#pragma once

#include <string>

#include "cullhull/extreme_points.hpp"
#include "cullhull/options.hpp"
#include "stream/numbered_points.hpp"

namespace cullhull::internal {

/// extreme_points() by a hull where that is sooner and fits.
ExtremePoints find_extreme(const PointView& points, const Options& options);

/// Orders the points by id and leaves the extreme ones, of equal points that with the lowest id.
/// Coordinates must be finite. Errors as extreme_points.
void keep_extreme(NumberedPoints& points, const Options& options);

/// The scalar type that holds two sets: that of points where only one has any, f64 where they
/// differ.
ScalarType common_scalar(ScalarType a, std::uint64_t count_a, ScalarType b, std::uint64_t count_b);

/// Error{not_finite} naming the id of the first of them that is not finite, if there is one.
void refuse_not_finite(const NumberedPoints& points, unsigned threads);

/// Error{invalid_argument} for what no block may be: null data, no dimension, another dimension
/// than `dimension` (0: any), ids beyond 2^64.
void check_block(const PointView& block, std::uint64_t first_id, std::uint32_t dimension);

}  // namespace cullhull::internal
