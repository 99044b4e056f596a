// GaugeMap: a radial pseudo-hull over a cube map (docs/algorithm.md, docs/exactness.md).
#pragma once

#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "cullhull/array.hpp"
#include "cullhull/point_view.hpp"

namespace cullhull::internal {

struct Run;
struct GaugeTable;

/// A convex polytope whose vertices are input points; the filter is built from it.
struct InnerPolytope {
  unsigned dimension = 0;
  /// Vertices, packed rows of exact input coordinates (untranslated, unscaled).
  std::vector<double> vertices;
  /// facets x d indices into vertices; oriented or not.
  std::vector<std::uint32_t> facets;
  /// facets x d: entry j is the facet across the ridge opposite to vertex j.
  std::vector<std::uint32_t> neighbours;
};

struct GaugeSettings {
  /// Cells along an edge of the cube map; 0: chosen from the facet count and the next three
  /// members.
  unsigned resolution = 0;
  double share = 1;               ///< factor for the number of nodes
  std::uint32_t least_nodes = 0;  ///< lower bound, as far as a CPU's cache holds the nodes
  std::uint32_t most_nodes = 0;   ///< upper bound; 0: as many as a CPU's cache holds
  /// Keeps the polytope, which outside_cones() needs.
  bool cones = false;
  /// False: the facets form nearly a convex polytope (say, after its vertices have moved). The map
  /// uses them if each direction from the centre meets exactly one of them; else there is no map.
  /// Needs cones.
  bool convex = true;
  unsigned threads = 1;
};

/// Along an edge of the cube of directions.
struct LeaderCells {
  unsigned leaders = 0;   ///< cells with a leader each
  unsigned nodes = 0;     ///< cells of the map
  bool recentre = false;  ///< the centre of the map before is that of a rough hull
  double filled = 0;      ///< no map where a smaller share of the cells has a leader
};

/// Rows of survivors, gathered by the pass that finds them while they are in its cache.
struct SurvivorRows {
  std::uint64_t most = ~std::uint64_t{0};  ///< no rows for more survivors than this
  /// Packed, as doubles, not checked for finiteness; empty if there are more survivors.
  Array<double> rows;
};

/// Immutable after construction; safe to share between threads.
class GaugeMap {
 public:
  static constexpr unsigned min_dimension = 2, max_dimension = 6;

  /// Returns null if no useful map exists (the centre is not strictly inside in floating point,
  /// coordinates are too extreme, ...): the caller then culls nothing. The map does not depend on
  /// the number of threads.
  static std::unique_ptr<GaugeMap> build(InnerPolytope polytope, const GaugeSettings& settings);
  static std::unique_ptr<GaugeMap> build(InnerPolytope polytope, unsigned resolution = 0,
                                         std::uint32_t most_nodes = 0) {
    return build(std::move(polytope),
                 GaugeSettings{.resolution = resolution, .most_nodes = most_nodes});
  }

  /// Builds the map of an exact 3D hull, outward oriented, with few facets: testing every node
  /// against all of them is then faster than walks. Returns null where build() would.
  static std::unique_ptr<GaugeMap> of_few_facets(const InnerPolytope& polytope,
                                                 unsigned resolution);

  /// Builds the map of the hull of `rows` (packed, finite, in any order) without that hull: from
  /// the leaders, in each cell of directions the point that a map `before`, of fewer points, finds
  /// outermost. The bound at a node is that of the best simplex of leaders nearby. Returns null
  /// where build() would. Time O(rows + nodes), shared by all threads; the map does not depend on
  /// their number. From 3D on. Source: docs/exactness.md, G1, G2 and "Leaders".
  static std::unique_ptr<GaugeMap> of_leaders(const Array<double>& rows, const GaugeMap& before,
                                              const LeaderCells& cells, const Run& run);

  /// Returns the ids (ascending, indices into `points`) of all points that are not provably
  /// strictly inside the polytope, which include every point with a NaN or an infinity. `rows`, if
  /// given, receives their coordinates.
  Array<std::uint64_t> survivors(const PointView& points, const Run& run,
                                 SurvivorRows* rows = nullptr) const;

  /// Returns the positions (ascending) of those packed rows of finite points that are not provably
  /// strictly inside the polytope, tested by the facet through which each point's ray leaves:
  /// slower than survivors(), but exact up to rounding. Rows marked `certain` are returned without
  /// a test. Needs a map built with cones.
  std::vector<std::uint64_t> outside_cones(const Array<double>& rows,
                                           const std::vector<char>& certain, const Run& run) const;

  /// Applies the same test to one point.
  bool inside_cones(const double* row) const;

  /// The data that the kernels read.
  const GaugeTable& table() const noexcept;

  ~GaugeMap();

 private:
  struct Table;
  explicit GaugeMap(std::unique_ptr<Table> table);
  std::unique_ptr<Table> table_;
};

}  // namespace cullhull::internal
