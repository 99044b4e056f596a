// Interpolation of values given at points.
#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <vector>

#include "cullhull/options.hpp"
#include "cullhull/point_view.hpp"
#include "cullhull/triangulation.hpp"
#include "cullhull/triangulation_query.hpp"

#pragma GCC visibility push(default)
namespace cullhull {

/// The vertices that contribute to a point's value, ascending, and their weights.
struct NaturalNeighbours {
  std::vector<std::uint32_t> ids;
  std::vector<double> weights;
};

/// Values at the vertices of a triangulation by delaunay(), prepared for interpolation. All members
/// are const and thread safe; points, triangulation and values are copied.
class Interpolator {
 public:
  /// `values`: point_count x components numbers; of equal points, the representative's value
  /// counts. Errors: those of TriangulationQuery; invalid_argument for 0 components, and for a
  /// weighted or furthest-site triangulation.
  Interpolator(const PointView& points, const Triangulation& triangulation, const double* values,
               std::uint32_t components = 1, const RunOptions& options = {});
  ~Interpolator();
  Interpolator(Interpolator&&) noexcept;
  Interpolator& operator=(Interpolator&&) noexcept;

  std::uint32_t components() const noexcept;
  const TriangulationQuery& query() const noexcept;

  /// Linear in each cell: the sum, in the order of the cell's ids, of the corners' values times
  /// their exact barycentric coordinates, rounded (each within 2^-50 max(1, |itself|)). On a face
  /// shared by cells, the cell of lowest number is used; at a vertex the result is its value.
  /// Points in no cell get `outside`. `out`: points x components.
  void linear(const PointView& points, double* out,
              double outside = std::numeric_limits<double>::quiet_NaN(),
              const RunOptions& options = {}) const;

  /// The value of the nearest vertex, exactly; of several, that of the lowest id. `outside` if
  /// there are no vertices.
  void nearest(const PointView& points, double* out,
               double outside = std::numeric_limits<double>::quiet_NaN(),
               const RunOptions& options = {}) const;

  /// Natural neighbour interpolation (Sibson 1981). Inserting the point among the vertices would
  /// take a part of the volume of each neighbour's Voronoi cell; these shares are the weights of
  /// the vertices. The interpolant is continuous, smooth except at the vertices, and reproduces
  /// linear functions; on the boundary of the hull the weights are those within the face (linear on
  /// an edge), which is their limit there. At a vertex the result is its value. For triangulations
  /// of affine dimension 1 (linear), 2 and 3, else Error{invalid_argument}. `out`, `outside` as for
  /// linear(). Time: a few microseconds per point in 2D, some ten in 3D. Source: docs/exactness.md,
  /// "Natural neighbours".
  void natural(const PointView& points, double* out,
               double outside = std::numeric_limits<double>::quiet_NaN(),
               const RunOptions& options = {}) const;

  /// The weights for one point (d numbers), each at least 0 and within 2^-51 of the exact one, so
  /// the sum of n weights is 1 within n 2^-51. Empty outside the hull. Errors as above, not_finite.
  NaturalNeighbours natural_neighbours(const double* point) const;
  NaturalNeighbours natural_neighbours(const OnePoint& point) const {
    return natural_neighbours(point.of(query().dimension()));
  }

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace cullhull
#pragma GCC visibility pop
