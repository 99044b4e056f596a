// A hull to which points are added in batches.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "cullhull/hull.hpp"
#include "cullhull/options.hpp"
#include "cullhull/point_view.hpp"

#pragma GCC visibility push(default)
namespace cullhull {

/// The hull of all points added so far. It stores coordinates of the vertices only. Ids number the
/// points in the order in which they were added.
///
/// add() tests the new points against the current hull (as HullQuery does, in parallel). If some
/// are outside, it computes the hull of the vertices and of these points: O(new points) plus the
/// cost of a hull of that many points, however many were added before. A batch inside the hull
/// costs only the tests. Not thread safe; a failed or cancelled add() leaves the object unchanged.
class GrowingHull {
 public:
  explicit GrowingHull(std::uint32_t dimension);
  /// Starts from an existing hull, as if all its points had been added. `vertex_coordinates`: one
  /// row per vertex, by ascending id; Error{invalid_argument} for another number of rows.
  GrowingHull(Hull hull, std::vector<double> vertex_coordinates);
  ~GrowingHull();
  GrowingHull(GrowingHull&&) noexcept;
  GrowingHull& operator=(GrowingHull&&) noexcept;

  /// Returns how many of the points lie outside the previous hull (0: only the count of points
  /// changes). Errors as convex_hull; Error{not_finite} names the index within `points`;
  /// Error{invalid_argument} if the dimension differs.
  std::uint64_t add(const PointView& points, const Options& options = {});

  /// Equal to convex_hull of all points at once, bit for bit, except for `statistics`, which
  /// describe the last change. (`scalar` becomes f64 as soon as two added views differ in it.)
  const Hull& hull() const noexcept;
  /// The coordinates of the vertices, one row each, by ascending id.
  const std::vector<double>& vertex_coordinates() const noexcept;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace cullhull
#pragma GCC visibility pop
