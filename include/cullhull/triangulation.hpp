// Delaunay and regular triangulations in any dimension: exact and canonical (the same bits for
// every order of work and thread count).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "cullhull/array.hpp"
#include "cullhull/certify.hpp"
#include "cullhull/options.hpp"
#include "cullhull/point_view.hpp"

#pragma GCC visibility push(default)
namespace cullhull {

struct TriangulationOptions {
  CULLHULL_RUN_OPTIONS
  /// Compute the furthest-site triangulation, the dual of the furthest-point Voronoi diagram: the
  /// upper hull of the lifted points instead of the lower one. Its vertices are extreme points, all
  /// others are hidden. The only option that changes the result.
  bool furthest_site = false;
};

struct TriangulationStatistics {
  /// Signs by the stage that decided them (docs/exactness.md, "Lifting"): doubles, double-doubles,
  /// integers.
  std::uint64_t rung_counts[3] = {0, 0, 0};
  /// In-sphere tests that were exactly zero, decided by the ids.
  std::uint64_t ties = 0;
  /// Cells created during the construction, including those of the result.
  std::uint64_t cells_created = 0;
  unsigned threads = 1;
  double order_seconds = 0;   ///< reading, order of insertion, equal points, flat
  double insert_seconds = 0;  ///< all insertions
  double write_seconds = 0;   ///< building the canonical result
  double compute_seconds = 0;
};

/// A duplicate point and its representative, a point with the same coordinates.
struct DuplicatePoint {
  std::uint32_t id = 0, representative = 0;
  friend bool operator==(const DuplicatePoint&, const DuplicatePoint&) = default;
};

/// k below is `affine_dimension`: the dimension of the flat that the points span (-1: no points, 0:
/// all equal, ..., `dimension`: full). Points in a flat are triangulated within it; orientation is
/// then that of the points projected onto `axes`.
///
/// The triangulation is the lower hull of the points lifted to |x|^2 (minus the weight). Cells with
/// the same circumsphere are merged and divided again by pulling: from the lowest id of all their
/// vertices, then for each face from its own lowest id. This triangulation is unique; it does not
/// depend on the order of work, threads or scalar type.
///
/// Functions that take one throw Error{invalid_argument} if its lists have wrong sizes or hold ids
/// or numbers that do not exist, if a walk by its neighbours does not end, and for a cell that is
/// flat where they divide by its volume. certify() checks all the rest.
struct Triangulation {
  std::uint32_t dimension = 0;
  std::uint64_t point_count = 0;
  ScalarType scalar = ScalarType::f64;
  int affine_dimension = -1;
  bool furthest_site = false;
  bool weighted = false;  ///< made by regular_triangulation()
  /// k axes, ascending; the projection of the points' flat onto them is one to one. 0, 1, ... if k
  /// is `dimension`.
  std::vector<std::uint32_t> axes;

  /// cells x (k + 1) ids. Each cell is ascending, except that its last two ids are swapped if that
  /// is needed to orient it positively: det [p1 - p0; ...; pk - p0] > 0 (in the plane counter-
  /// clockwise). Cells are sorted lexicographically. k = 0: one cell of one id.
  Array<std::uint32_t> cells;
  /// cells x (k + 1): entry j is the cell across the facet opposite to vertex j, or no_index on the
  /// hull.
  Array<std::uint32_t> neighbours;
  /// Number of the group of each cell: cells with the same circumsphere that are connected through
  /// facets. Numbers start at 0 and ascend by first cell. Empty if every cell is a group of its
  /// own.
  Array<std::uint32_t> cell_groups;

  /// facets x k ids: the facets without a neighbour, each ascending except for its last two ids,
  /// which are swapped if that is needed to orient it outward as in Hull::simplices; sorted
  /// lexicographically. Empty for k < 1.
  Array<std::uint32_t> hull_facets;
  /// The cell that each hull facet belongs to.
  Array<std::uint32_t> hull_cells;

  /// Ascending by id. The representative of equal points is the lowest id; with weights, that of
  /// the largest weight (with furthest_site: of the smallest weight), then the lowest id.
  std::vector<DuplicatePoint> duplicates;
  /// Points that are neither vertices nor duplicates, ascending: with weights, those whose lifted
  /// point is not an extreme point of the lower hull; with furthest_site, of the upper hull.
  std::vector<std::uint32_t> hidden;

  TriangulationStatistics statistics;

  /// The number of vertices of a cell: k + 1.
  unsigned corners() const noexcept { return static_cast<unsigned>(affine_dimension + 1); }
  /// The number of cells.
  std::uint64_t size() const noexcept { return corners() == 0 ? 0 : cells.size() / corners(); }
  std::span<const std::uint32_t> cell(std::uint64_t i) const noexcept {
    return {cells.data() + i * corners(), corners()};
  }
  std::span<const std::uint32_t> neighbours_of(std::uint64_t i) const noexcept {
    return {neighbours.data() + i * corners(), corners()};
  }
  std::uint64_t hull_facet_count() const noexcept { return hull_cells.size(); }
  std::span<const std::uint32_t> hull_facet(std::uint64_t i) const noexcept {
    const auto k = corners() == 0 ? 0U : corners() - 1;
    return {hull_facets.data() + i * k, k};
  }
  /// The group of a cell; its own number if cell_groups is empty.
  std::uint32_t group(std::uint64_t i) const noexcept {
    return cell_groups.empty() ? static_cast<std::uint32_t>(i)
                               : cell_groups[static_cast<std::size_t>(i)];
  }
  std::uint64_t vertex_count() const noexcept {
    return point_count - duplicates.size() - hidden.size();
  }
};

/// The exact Delaunay triangulation of fewer than 2^32 - 1 points of any dimension d >= 1. Errors:
/// not_finite (names the first bad point), out_of_budget (also for too many points or cells for
/// 32-bit numbers; before the work if the counts show it), cancelled, invalid_argument. Expected
/// time O(n log n + n^ceil(d / 2)), about O(n log n) for points that do not concentrate on a
/// surface of lower dimension. Thread safe. Source: docs/delaunay.md; why it is exact:
/// docs/exactness.md, "Lifting".
Triangulation delaunay(const PointView& points, const TriangulationOptions& options = {});

/// The exact regular triangulation, the dual of the power diagram: point i is lifted to |x|^2 -
/// weights[i]. A point is a vertex if and only if its lifted point is an extreme point of the lower
/// hull; points exactly on a face of it are hidden, too. Errors as of delaunay(); invalid_argument
/// unless there is one weight per point, not_finite for a weight that is NaN or infinite.
Triangulation regular_triangulation(const PointView& points, std::span<const double> weights,
                                    const TriangulationOptions& options = {});

/// Verifies a triangulation with exact predicates, independently of the engine's code: lists, ids
/// and order; orientation of cells; mutual neighbours; a hull that is closed, convex and covered
/// once; every facet between two cells locally Delaunay, with the canonical choice among
/// cospherical points; every point a vertex, a duplicate or hidden; groups. So a valid certificate
/// proves that it is the triangulation documented above. `ridges_checked` counts facets between
/// cells. Time O(cells d^3), memory O(cells). Options used: threads, stop, progress. Errors:
/// cancelled; invalid_argument for null data, dimension 0, or another number of weights than
/// points.
Certificate certify(const PointView& points, const Triangulation& triangulation,
                    const TriangulationOptions& options = {});
/// The same for a regular triangulation.
Certificate certify(const PointView& points, std::span<const double> weights,
                    const Triangulation& triangulation, const TriangulationOptions& options = {});

}  // namespace cullhull
#pragma GCC visibility pop
