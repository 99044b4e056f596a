// Points that have left their block: their global ids, and their coordinates bit for bit.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "cullhull/point_view.hpp"

namespace cullhull::internal {

struct NumberedPoints {
  std::uint32_t dimension = 0;
  ScalarType scalar = ScalarType::f64;
  std::vector<std::uint64_t> ids;
  std::vector<std::byte> rows;  ///< packed, a row for each id

  std::size_t size() const { return ids.size(); }
  std::size_t row_bytes() const { return dimension * scalar_size(scalar); }
  /// Of memory for each point.
  std::size_t point_bytes() const { return row_bytes() + sizeof(std::uint64_t); }
  PointView view() const;

  /// Adds the points first + positions[i], i < count, of a view of the same dimension and scalar
  /// type; positions null: first + i. Their ids are `first_id` beyond their place in the view.
  void append(const PointView& from, std::uint64_t first, const std::uint32_t* positions,
              std::size_t count, std::uint64_t first_id);
  /// Adds others of the same dimension and scalar type.
  void append(const NumberedPoints& other);
  /// Coordinates become doubles.
  void widen();
  /// Orders by id; of an id that comes twice one is left.
  void sort();
  /// Leaves those at these places, in that order.
  void keep(const std::vector<std::uint64_t>& places);

 private:
  void grow(std::size_t more);  ///< all of it or, where there is no memory, nothing
};

/// Copies rows of a view, packed: those of first + positions[i], or first + i.
void copy_rows(const PointView& from, std::uint64_t first, const std::uint32_t* positions,
               std::size_t count, std::byte* out);

}  // namespace cullhull::internal
