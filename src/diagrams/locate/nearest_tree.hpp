// A k-d tree for the nearest of some points, exactly: doubles with a bound choose the candidates,
// exact comparisons decide between them.
#pragma once

#include <cstdint>
#include <memory>

#include "cullhull/point_view.hpp"
#include "cullhull/triangulation_query.hpp"

namespace cullhull::internal {

struct Run;
class NearestTree {
 public:
  /// The most dimensions it takes: with more, a tree visits most of its leaves.
  static constexpr unsigned most_dimensions = NearestPoint::most_dimensions;

  /// What is done with queries whose distances to all points are nearly equal, as they are
  /// 2^30 times as far away as the points from each other. They take a time in proportion to the
  /// number of points.
  enum class FarQueries { answered, left_out };

  /// `rows`: the coordinates of the points, finite, one point after the other; `names`: their ids,
  /// distinct and below no_index, or null if their places are their ids. At least one point. Copies
  /// what it needs; the result does not depend on the order of the points.
  static std::unique_ptr<const NearestTree> of(unsigned dimension, const double* rows,
                                               const std::uint32_t* names, std::uint32_t count,
                                               const Run& run);
  virtual ~NearestTree() = default;

  virtual unsigned dimension() const noexcept = 0;

  /// The id of the nearest point; of several, the lowest. no_index if the query is left out.
  /// `query`: finite.
  virtual std::uint32_t nearest(const double* query, FarQueries far) const = 0;

  /// The same for many. Returns whether any query is left out.
  virtual bool nearest(const PointView& queries, FarQueries far, std::uint32_t* out,
                       const Run& run) const = 0;
};

}  // namespace cullhull::internal
