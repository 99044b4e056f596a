// The exact step of a stream: which of the points it holds are extreme.
#pragma once

#include <string>

#include "cullhull/extreme_points.hpp"
#include "cullhull/options.hpp"
#include "stream/numbered_points.hpp"

namespace cullhull::internal::inline stream {

/// extreme_points(), by a hull where that is faster and fits.
ExtremePoints find_extreme(const PointView& points, const Options& options);

/// Sorts the points by id and keeps the extreme ones, of equal points the one with the lowest id.
/// Coordinates must be finite. Errors as extreme_points.
void keep_extreme(NumberedPoints& points, const Options& options);

/// The scalar type that can hold two sets: that of the other where one is empty, f64 where they
/// differ.
ScalarType common_scalar(ScalarType a, std::uint64_t count_a, ScalarType b, std::uint64_t count_b);

/// Throws Error{not_finite} naming the id of the first point that is not finite, if there is one.
void refuse_not_finite(const NumberedPoints& points, unsigned threads);

/// Throws Error{invalid_argument} for a block with null data, no dimension, another dimension than
/// `dimension` (0: any), or ids beyond 2^64.
void check_block(const PointView& block, std::uint64_t first_id, std::uint32_t dimension);

}  // namespace cullhull::internal::inline stream
