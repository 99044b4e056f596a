// Queries to a finished triangulation: the cell that contains a point, barycentric coordinates, and
// the nearest vertex; and to points alone: the nearest of them.
#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include "cullhull/options.hpp"
#include "cullhull/point_view.hpp"
#include "cullhull/triangulation.hpp"

#pragma GCC visibility push(default)
namespace cullhull {

/// A triangulation prepared for queries. Cells and nearest vertices are exact: there is no
/// tolerance, and no order of queries, thread count or start changes an answer.
///
/// Construction takes O(cells k) time and memory, and copies what it needs: neither the points nor
/// the triangulation must outlive it. All members are const and thread safe. Query points are d =
/// triangulation.dimension finite numbers; a NaN or an infinity is Error{not_finite} (which names
/// the first index in the batched forms), another dimension Error{invalid_argument}.
///
/// A query is a visibility walk: from a near cell it crosses facets that separate the cell from the
/// point; it terminates because the triangulation is regular. Batches are sorted along a
/// space-filling curve and walk from one answer to the next, a few cells each. In 2D to 4D maps
/// from coordinates to barycentric ones are made when so much has been asked that they pay, if
/// those of all cells take no more than 16 MB (160,000 cells in the plane, 87,000 in space, 52,000
/// in 4D): a question then takes 10 to 40 ns. Source: docs/exactness.md, "Points in cells".
class TriangulationQuery {
 public:
  /// `points` and `weights`: those of the triangulation; nearest() needs the weights.
  TriangulationQuery(const PointView& points, const Triangulation& triangulation,
                     std::span<const double> weights = {}, const RunOptions& options = {});
  ~TriangulationQuery();
  TriangulationQuery(TriangulationQuery&&) noexcept;
  TriangulationQuery& operator=(TriangulationQuery&&) noexcept;

  std::uint32_t dimension() const noexcept;
  /// Number of coordinates that barycentric() gives: k + 1; 0 if there are no cells.
  unsigned corners() const noexcept;

  /// The cell that contains the point; on a face shared by cells, the lowest number. no_index
  /// outside, and for a point off the flat of a flat triangulation.
  std::uint32_t find(const double* point) const;
  std::uint32_t find(const OnePoint& point) const { return find(point.of(dimension())); }

  /// The point as an affine combination of the cell's corners: k + 1 numbers in the order of its
  /// ids, each within 2^-50 max(1, |itself|) of exact and of exact sign; zero if the point is on
  /// the facet opposite to that corner (or the number is below all doubles), negative beyond that
  /// facet. A point off the flat is projected along the axes that are not in Triangulation::axes.
  /// no_index: NaN.
  void barycentric(const double* point, std::uint32_t cell, double* out) const;
  void barycentric(const OnePoint& point, std::uint32_t cell, double* out) const {
    barycentric(point.of(dimension()), cell, out);
  }

  /// The id of the vertex nearest to the point, exactly; of several, the lowest id. With weights,
  /// the vertex of the least power |x - p|^2 - w; for a furthest-site triangulation the furthest
  /// vertex. no_index if there are no vertices. Time: O(cells k^2) once, in the first call, then a
  /// walk over edges; without weights in 3D to 8D mostly a tree as that of NearestPoint instead.
  std::uint32_t nearest(const double* point) const;
  std::uint32_t nearest(const OnePoint& point) const { return nearest(point.of(dimension())); }

  /// The same for many points: `out` receives one item (barycentric: k + 1) per point; `cells`:
  /// results of find() or any other cells. Parallel over options.threads, with options.stop and
  /// options.progress.
  ///
  /// With a `tolerance` above 0 find() also puts points into a cell that are outside by rounding
  /// alone: none of their barycentric coordinates in it is below -tolerance, and they reach it by a
  /// step towards the mean of all vertices, of min(4 tolerance, 2^-20) of the way or a quarter of
  /// that. Not if the points are in a flat.
  void find(const PointView& points, std::uint32_t* out, const RunOptions& options = {},
            double tolerance = 0) const;
  void barycentric(const PointView& points, const std::uint32_t* cells, double* out,
                   const RunOptions& options = {}) const;
  void nearest(const PointView& points, std::uint32_t* out, const RunOptions& options = {}) const;

  /// Linear interpolation: for each point the sum of `values` (`components` numbers for each point
  /// of the triangulation) of the corners of its cell, in the order of its ids, times barycentric
  /// coordinates: the nearest doubles, or as barycentric() has them (which of the two may depend on
  /// the questions before); a value times zero has no effect, even if it is a NaN.
  /// The cell is that of find() with this tolerance. Points in no cell get `outside`: its numbers
  /// again and again, at least one. `out`: points x components.
  void interpolate(const PointView& points, const double* values, std::uint32_t components,
                   std::span<const double> outside, double* out, const RunOptions& options = {},
                   double tolerance = 0) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// Points prepared for queries for the nearest of them, without a triangulation. Answers are exact:
/// no order of queries or thread count changes one.
///
/// At least one point, at most 2^32 - 2, in 1 to most_dimensions; others are
/// Error{invalid_argument}, a NaN or an infinity Error{not_finite}, which names the first index.
/// Construction takes O(n log n) time and memory for the coordinates twice, and copies what it
/// needs: the points need not outlive it. nearest() is const and thread safe.
///
/// A k-d tree: a query takes O(log n) in few dimensions, and up to O(n) where many points are
/// nearly as near as the nearest one, as for a query that is very far from all.
/// Source: docs/exactness.md, "Points in cells".
class NearestPoint {
 public:
  static constexpr unsigned most_dimensions = 8;

  explicit NearestPoint(const PointView& points, const RunOptions& options = {});
  ~NearestPoint();
  NearestPoint(NearestPoint&&) noexcept;
  NearestPoint& operator=(NearestPoint&&) noexcept;

  std::uint32_t dimension() const noexcept;

  /// The id of the point nearest to the query, exactly; of several, the lowest id. `query`: as many
  /// finite numbers as the points have; a NaN or an infinity is Error{not_finite}.
  std::uint32_t nearest(const double* query) const;
  std::uint32_t nearest(const OnePoint& query) const { return nearest(query.of(dimension())); }

  /// The same for many queries: `out` receives one id per query. Error{not_finite} names the first
  /// index; queries of another dimension are Error{invalid_argument}. Parallel over
  /// options.threads, with options.stop and options.progress.
  void nearest(const PointView& queries, std::uint32_t* out, const RunOptions& options = {}) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace cullhull
#pragma GCC visibility pop
