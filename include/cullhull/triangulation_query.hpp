// Questions to a finished triangulation: which cell has a point, where in it, which vertex is
// nearest.
#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include "cullhull/options.hpp"
#include "cullhull/point_view.hpp"
#include "cullhull/triangulation.hpp"

#pragma GCC visibility push(default)
namespace cullhull::inline v1 {

/// A triangulation prepared for questions. Cells and nearest vertices are exact: there is no
/// tolerance, and no order of questions, thread count or start changes an answer.
///
/// Construction takes O(cells k) time and memory, and copies what it needs: neither the points nor
/// the triangulation must outlive it. All members are const and thread safe. Points asked about are
/// d = triangulation.dimension finite numbers; a NaN or an infinity is Error{not_finite} (naming
/// the first index in the batched forms), another dimension Error{invalid_argument}.
///
/// One question walks from a near cell over facets that the point is beyond, which ends because the
/// triangulation is regular. Batches are sorted along a curve and walk from one answer to the next:
/// a few cells each.
/// Source: docs/exactness.md, "Points in cells".
class TriangulationQuery {
 public:
  /// `points`: those the triangulation was made of; `weights` likewise, if it had any: nearest()
  /// needs them.
  TriangulationQuery(const PointView& points, const Triangulation& triangulation,
                     std::span<const double> weights = {}, const RunOptions& options = {});
  ~TriangulationQuery();
  TriangulationQuery(TriangulationQuery&&) noexcept;
  TriangulationQuery& operator=(TriangulationQuery&&) noexcept;

  /// k + 1 of the triangulation: how many coordinates barycentric() gives; 0 if it has no cell.
  unsigned corners() const noexcept;

  /// The cell that the point is in; on faces that cells share, the lowest of their numbers. no_cell
  /// outside, and for a point off the flat of a flat triangulation.
  std::uint32_t find(const double* point) const;

  /// The affine combination of the cell's corners that is the point: k + 1 numbers in the order of
  /// its ids, each within 2^-50 max(1, |itself|) of exact, of exact sign, zero where the point is
  /// on the facet opposite to that corner (or the number below all doubles), negative beyond. A
  /// point off the flat is taken along the axes that the triangulation leaves out. no_cell: NaN.
  void barycentric(const double* point, std::uint32_t cell, double* out) const;

  /// The id of the vertex nearest to the point, exactly; of several, the lowest id. With weights
  /// that of the least power |x - p|^2 - w; for a triangulation of the furthest site the furthest
  /// vertex. no_cell if there is none. Time: of the first call once O(cells k^2), then a walk over
  /// edges.
  std::uint32_t nearest(const double* point) const;

  /// The same for many: `out` holds an item (barycentric: k + 1) a point, `cells` what find() gave
  /// or any others. In parallel over options.threads, with options.stop and options.progress.
  void find(const PointView& points, std::uint32_t* out, const RunOptions& options = {}) const;
  void barycentric(const PointView& points, const std::uint32_t* cells, double* out,
                   const RunOptions& options = {}) const;
  void nearest(const PointView& points, std::uint32_t* out, const RunOptions& options = {}) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace cullhull::inline v1
#pragma GCC visibility pop
