// Points copied out of their block: global ids, and coordinates bit for bit.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "cullhull/array.hpp"
#include "cullhull/point_view.hpp"

namespace cullhull::internal::inline stream {

struct NumberedPoints {
  std::uint32_t dimension = 0;
  ScalarType scalar = ScalarType::f64;
  Array<std::uint64_t> ids;
  Array<std::byte> rows;  ///< packed, a row for each id

  std::size_t size() const { return ids.size(); }
  std::size_t row_bytes() const { return dimension * scalar_size(scalar); }
  /// Memory a point.
  std::size_t point_bytes() const { return row_bytes() + sizeof(std::uint64_t); }
  PointView view() const;

  /// Appends the points first + positions[i], i < count, of a view of the same dimension and scalar
  /// type; positions null: first + i. Their ids are `first_id` plus their index in the view.
  void append(const PointView& from, std::uint64_t first, const std::uint32_t* positions,
              std::size_t count, std::uint64_t first_id);
  /// The same for the points of these indices.
  void append(const PointView& from, const std::vector<std::uint64_t>& indices,
              std::uint64_t first_id);
  /// Appends others of the same dimension and scalar type.
  void append(const NumberedPoints& other);
  /// Appends others of the same dimension and scalar type, and frees them; no more room is taken
  /// than the points need. Both are unchanged where that throws.
  void take(NumberedPoints& other);
  /// Converts the coordinates to doubles.
  void widen();
  /// Sorts by id and keeps one of points that are repeated. Throws Error{invalid_argument} where
  /// two points with one id differ, and leaves them unchanged.
  void sort();
  /// Keeps those at these positions, in that order.
  void keep(const std::vector<std::uint64_t>& places);

 private:
  void grow(std::size_t more);  ///< reserves for `more` points; unchanged where that throws
};

/// Copies rows of a view, packed: those of first + positions[i], or first + i.
void copy_rows(const PointView& from, std::uint64_t first, const std::uint32_t* positions,
               std::size_t count, std::byte* out);

}  // namespace cullhull::internal::inline stream
