// Values at points, interpolated between them.
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
namespace cullhull::inline v1 {

/// The vertices that a point's value comes from, ascending, and their shares.
struct NaturalNeighbours {
  std::vector<std::uint32_t> ids;
  std::vector<double> weights;
};

/// Values at the vertices of a triangulation made by delaunay(), prepared for interpolation. All
/// members are const and thread safe; points, triangulation and values are copied.
class Interpolator {
 public:
  /// `values`: point_count x components numbers; of equal points that of the one that stands in
  /// counts. Errors: as of TriangulationQuery; invalid_argument for no components, and for a
  /// triangulation that is weighted or of the furthest site.
  Interpolator(const PointView& points, const Triangulation& triangulation, const double* values,
               std::uint32_t components = 1, const RunOptions& options = {});
  ~Interpolator();
  Interpolator(Interpolator&&) noexcept;
  Interpolator& operator=(Interpolator&&) noexcept;

  std::uint32_t components() const noexcept;
  const TriangulationQuery& query() const noexcept;

  /// Linear in each cell: the corners' values by their exact barycentric coordinates, rounded (each
  /// within 2^-50 max(1, |itself|)), summed in the order of the cell's ids. On faces that cells
  /// share the cell of lowest number counts; at a vertex the result is its value. `outside` where
  /// no cell is. `out`: points x components.
  void linear(const PointView& points, double* out,
              double outside = std::numeric_limits<double>::quiet_NaN(),
              const RunOptions& options = {}) const;

  /// The value of the nearest vertex, exactly the nearest, of several the lowest id. `outside`
  /// where there is no vertex at all.
  void nearest(const PointView& points, double* out,
               double outside = std::numeric_limits<double>::quiet_NaN(),
               const RunOptions& options = {}) const;

  /// Sibson's natural neighbours (1981): inserted among the vertices, the point's Voronoi cell
  /// takes from the cell of each vertex a share of its volume, which is the vertex's weight. Values
  /// are continuous, smooth but for the vertices, and linear ones stay so; on the boundary of the
  /// hull the shares are those within the face (on an edge linear), which is their limit there. At
  /// a vertex the result is its value. For triangulations of affine dimension 1 to 3 (1: linear),
  /// else Error{invalid_argument}. `out`, `outside` as for linear(). Time: some microseconds a
  /// point in the plane, some ten in space. Source: docs/exactness.md, "Natural neighbours".
  void natural(const PointView& points, double* out,
               double outside = std::numeric_limits<double>::quiet_NaN(),
               const RunOptions& options = {}) const;

  /// The weights of one point, d numbers: each within 2^-51 of exact and not negative, so that n of
  /// them add up to 1 within n 2^-51. None outside. Errors as above, not_finite.
  NaturalNeighbours natural_neighbours(const double* point) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace cullhull::inline v1
#pragma GCC visibility pop
