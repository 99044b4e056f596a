// Points copied out of their blocks, with global ids and exact coordinates; their reduction to the
// extreme points, and conversion to and from HullState.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "cullhull/array.hpp"
#include "cullhull/extreme_points.hpp"
#include "cullhull/hull_fwd.hpp"
#include "cullhull/options.hpp"
#include "cullhull/point_view.hpp"
#include "cullhull/stream.hpp"

namespace cullhull::internal {

struct Run;

struct NumberedPoints {
  std::uint32_t dimension = 0;
  ScalarType scalar = ScalarType::f64;
  Array<std::uint64_t> ids;
  Array<std::byte> rows;  ///< packed, one row per id

  std::size_t size() const { return ids.size(); }
  std::size_t row_bytes() const { return dimension * scalar_size(scalar); }
  /// Bytes per point.
  std::size_t point_bytes() const { return row_bytes() + sizeof(std::uint64_t); }
  PointView view() const;

  /// Appends points of a view of the same dimension and scalar type: first + positions[i], i <
  /// count (positions null: first + i). Their ids are `first_id` plus their index in the view.
  void append(const PointView& from, std::uint64_t first, const std::uint32_t* positions,
              std::size_t count, std::uint64_t first_id);
  /// Appends the points `positions` of a view of the same dimension and scalar type.
  void append(const PointView& from, const std::vector<std::uint64_t>& positions,
              std::uint64_t first_id);
  /// Appends points of the same dimension and scalar type.
  void append(const NumberedPoints& other);
  /// The same, and frees `parts`; allocates no more than the points need. If that throws, all are
  /// unchanged.
  void take(std::vector<NumberedPoints>& parts, const Run& run);
  /// Converts the coordinates to doubles.
  void widen();
  /// Sorts by id and removes repeated points. Throws Error{invalid_argument} if two points with the
  /// same id differ, and leaves the points unchanged.
  void sort(const Run& run);
  /// Keeps the points at these positions, in that order.
  template <class Places>
  void keep(const Places& places, const Run& run);

 private:
  void grow(std::size_t more);  ///< reserves for `more` points; strong exception guarantee
};

/// Copies rows of a view, packed: first + positions[i] (positions null: first + i), i < count.
void copy_rows(const PointView& from, std::uint64_t first, const std::uint32_t* positions,
               std::size_t count, std::byte* out);

// The exact step of a stream: reduces points to the extreme ones.

/// Sorts the points by id and keeps the extreme ones; of equal points the one with the lowest id.
/// Coordinates must be finite. Errors as of extreme_points(). `hull`, if given, receives the hull
/// of all of them; it is left alone for fewer than 2 points, or if its facets exceed the budget.
void keep_extreme(NumberedPoints& points, const Options& options, Hull* hull = nullptr);

/// The scalar type that represents two sets: that of the other if one is empty, f64 if they differ.
ScalarType common_scalar(ScalarType a, std::uint64_t count_a, ScalarType b, std::uint64_t count_b);

/// Throws Error{not_finite} with the id of the first point that is not finite, if there is one.
void refuse_not_finite(const NumberedPoints& points, unsigned threads);

/// Throws Error{invalid_argument} for a block with null data, dimension 0, another dimension than
/// `dimension` (0: any), or ids beyond 2^64.
void check_block(const PointView& block, std::uint64_t first_id, std::uint32_t dimension);

/// Converts between a HullState and its points, for HullStream and others.
struct StateParts {
  /// The state of `seen` points with these extreme points, whose ids ascend.
  static HullState state(const NumberedPoints& points, std::uint64_t seen) {
    HullState state;
    state.dimension_ = points.dimension;
    state.scalar_ = points.scalar;
    state.seen_ = seen;
    state.ids_.assign(points.ids.begin(), points.ids.end());
    state.rows_.assign(points.rows.begin(), points.rows.end());
    return state;
  }
  static NumberedPoints points(const HullState& state) {
    return {state.dimension_,
            state.scalar_,
            {state.ids_.begin(), state.ids_.end()},
            {state.rows_.begin(), state.rows_.end()}};
  }
};

}  // namespace cullhull::internal
