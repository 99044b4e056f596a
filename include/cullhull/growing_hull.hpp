// A hull that takes more points as they come.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "cullhull/hull.hpp"
#include "cullhull/options.hpp"
#include "cullhull/point_view.hpp"

#pragma GCC visibility push(default)
namespace cullhull::inline v1 {

/// Keeps the hull of all points added so far. Of the points it keeps only the vertices'
/// coordinates. Ids number the points in the order in which they were added.
///
/// add() tests the new points against the present hull (as HullQuery does, in parallel) and, if any
/// is outside, computes the hull of the vertices and those: O(new points) plus the cost of a hull
/// of that many points, however many were added before. A batch that changes nothing costs its
/// tests. Not thread safe; a failed or cancelled add() leaves the object as it was.
class GrowingHull {
 public:
  explicit GrowingHull(std::uint32_t dimension);
  /// Starts from a hull computed elsewhere, as if all its points had been added.
  /// `vertex_coordinates`: a row for each vertex, by ascending id, as below;
  /// Error{invalid_argument} for another number of rows.
  GrowingHull(Hull hull, std::vector<double> vertex_coordinates);
  ~GrowingHull();
  GrowingHull(GrowingHull&&) noexcept;
  GrowingHull& operator=(GrowingHull&&) noexcept;

  /// Errors as convex_hull; Error{not_finite} names the index within `points`.
  /// Error{invalid_argument} if the dimension differs. Returns how many of the points lie outside
  /// the hull before the call (0: only the count of points changes).
  std::uint64_t add(const PointView& points, const Options& options = {});

  /// The same as convex_hull of all points at once, bit for bit, but for `statistics`, which are
  /// those of the last change. (`scalar` is f64 as soon as two added views differ.)
  const Hull& hull() const noexcept;
  /// The coordinates of the vertices, a row each, by ascending id.
  const std::vector<double>& vertex_coordinates() const noexcept;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace cullhull::inline v1
#pragma GCC visibility pop
