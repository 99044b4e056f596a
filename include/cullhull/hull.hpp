// The convex hull of a point set: exact and canonical (the same bits for every backend, filter and
// thread count).
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "cullhull/array.hpp"
#include "cullhull/cull.hpp"
#include "cullhull/lists.hpp"
#include "cullhull/options.hpp"
#include "cullhull/point_view.hpp"

#pragma GCC visibility push(default)
namespace cullhull {

struct Statistics {
  std::uint64_t survivors = 0;           ///< points the filter kept (before lattices are thinned)
  UsedFilter filter = UsedFilter::none;  ///< as in Survivors
  std::string cull_reason;               ///< as in Survivors::reason
  Backend backend = Backend::cpu;        ///< as in Survivors; engines run on the CPU
  unsigned threads = 1;
  double cull_seconds = 0;
  double hull_seconds = 0;     ///< engine and result together
  double compute_seconds = 0;  ///< from points in memory to the complete result
  /// Orientation tests by the stage that decided them (docs/exactness.md): cached plane, filter,
  /// exact.
  std::uint64_t rung_counts[3] = {0, 0, 0};
};

/// k below is `affine_dimension`: the dimension of the flat that the points span (-1: no points, 0:
/// all equal, ..., `dimension`: full). The hull is computed within that flat.
struct Hull {
  std::uint32_t dimension = 0;
  std::uint64_t point_count = 0;
  ScalarType scalar = ScalarType::f64;
  int affine_dimension = -1;

  /// Extreme points (of equal points the lowest id), ascending; for k = 2 counter-clockwise from
  /// the lowest id (in a flat: in the orientation described in docs/algorithm.md).
  std::vector<std::uint64_t> vertices;

  /// Maximal facets (coplanar pieces merged), as vertex ids. k = 3: in cyclic order,
  /// counter-clockwise from outside, from the lowest id. k = 2: the two ends, counter-clockwise.
  /// Otherwise ascending. Facets are ordered by their first simplex. Shares memory with `simplices`
  /// if every facet is one simplex and lists its vertices in the same order.
  Lists<std::uint64_t, SharedArray<std::uint64_t>> facets;
  /// The facets that share a ridge with facet i. k = 3: entry j is across the edge from vertex j to
  /// vertex j + 1 (cyclic). k = 2: across vertex 1, across vertex 0, as for simplices. Otherwise
  /// ascending.
  Lists<std::uint32_t> facet_neighbours;
  /// facets x (dimension + 1): outward unit normal, then offset; normal . x + offset <= 0 for every
  /// point, up to rounding. For a flat hull the normal is parallel to the flat. docs/exactness.md,
  /// "Numbers", states the accuracy, which certify() checks.
  Array<double> facet_planes;

  /// simplices x k vertex ids: every facet triangulated by pulling from its lowest id
  /// (recursively), simplices sorted. Each simplex is ascending, except that its last two ids are
  /// swapped if that is needed to orient it outward (never for k = 1).
  SharedArray<std::uint64_t> simplices;
  /// simplices x k: entry j is the simplex across the ridge opposite to vertex j.
  Array<std::uint32_t> simplex_neighbours;
  /// The facet that each simplex is part of; uses no memory if facet i is simplex i for all i.
  EvenArray<std::uint32_t> simplex_facets;

  /// k-measure of the hull (length, area, volume, ...), (k-1)-measure of its boundary (for k = 1:
  /// 2, the end points), and centroid, in the units of the points. 0 or empty where undefined.
  double volume = 0;
  double area = 0;
  std::vector<double> centroid;

  /// vertices x dimension, in the order of `vertices`, if Options::with_coordinates asked for them;
  /// else empty.
  Array<double> vertex_coordinates;

  Statistics statistics;

  std::uint64_t facet_count() const noexcept { return facets.size(); }
  std::uint64_t simplex_count() const noexcept { return simplex_facets.size(); }
  bool has_coordinates() const noexcept {
    return vertex_coordinates.size() == vertices.size() * dimension;
  }

  /// The vertex ids of facet i.
  std::span<const std::uint64_t> facet(std::uint64_t i) const {
    return facets[static_cast<std::size_t>(i)];
  }
  /// The k vertex ids of simplex i.
  std::span<const std::uint64_t> simplex(std::uint64_t i) const noexcept {
    const auto k = static_cast<std::size_t>(affine_dimension > 0 ? affine_dimension : 0);
    return {simplices.data() + i * k, k};
  }
  /// Facet i's outward unit normal (`dimension` numbers), then its offset.
  std::span<const double> plane(std::uint64_t i) const noexcept {
    return {facet_planes.data() + i * (dimension + 1), dimension + std::size_t{1}};
  }
  /// Coordinates of vertices[i], if has_coordinates().
  std::span<const double> coordinates(std::uint64_t i) const noexcept {
    return {vertex_coordinates.data() + i * dimension, dimension};
  }

  /// Replaces every vertex id v by of(v). An increasing `of` preserves all canonical orders.
  template <class Of>
  void rename(Of&& of) {
    const bool shared = facets.items.shares(simplices);
    for (std::uint64_t& v : vertices) v = of(v);
    if (shared) facets.items = {};
    for (std::uint64_t& v : simplices.edit()) v = of(v);
    if (shared)
      facets.items = simplices;
    else
      for (std::uint64_t& v : facets.items.edit()) v = of(v);
  }
};

/// The exact convex hull of any number of points in any dimension d >= 1. Errors: not_finite (names
/// the first bad index), out_of_budget (before the work if the counts show it, else when the hull
/// outgrows the budget), cancelled, backend_unavailable, invalid_argument. Time O(n) for the
/// filter, then expected O(h log h + h^floor(d / 2)) for its h survivors in random order. Extra
/// memory O(survivors + facets). Thread safe: calls share nothing. Source: docs/algorithm.md; why
/// it is exact: docs/exactness.md.
Hull convex_hull(const PointView& points, const Options& options = {});

}  // namespace cullhull
#pragma GCC visibility pop
