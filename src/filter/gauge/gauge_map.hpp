// GaugeMap: the radial pseudo-hull laid on a cube map (docs/algorithm.md, docs/exactness.md).
#pragma once

#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "cullhull/array.hpp"
#include "cullhull/point_view.hpp"
#include "parallel/threads/run.hpp"

namespace cullhull::internal::inline filter {

struct GaugeTable;

/// A convex polytope whose vertices are input points, from which the filter is built.
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
  /// Cells along an edge of the cube map; 0: chosen by the facet count and the next three members.
  unsigned resolution = 0;
  double share = 1;               ///< factor for the number of nodes
  std::uint32_t least_nodes = 0;  ///< at least so many, as far as a CPU's cache holds them
  std::uint32_t most_nodes = 0;   ///< at most so many; 0: as a CPU's cache holds
  /// Keeps the polytope, as outside_cones() needs.
  bool cones = false;
  /// False: the facets are only near those of a convex polytope (after its vertices have moved,
  /// say). They are used if each direction from the centre meets exactly one of them; else there is
  /// no map. Needs cones.
  bool convex = true;
  unsigned threads = 1;
};

/// Rows of survivors, gathered in the pass that finds them, while they are in its cache.
struct SurvivorRows {
  std::uint64_t most = ~std::uint64_t{0};  ///< no rows for more survivors than this
  /// Packed, as doubles, not checked for finiteness; empty where there are more survivors.
  Array<double> rows;
};

/// Immutable after construction; safe to share between threads.
class GaugeMap {
 public:
  static constexpr unsigned min_dimension = 2, max_dimension = 6;

  /// Returns null when no useful map exists (the centre is not strictly inside in floating point,
  /// coordinates too extreme, ...): the caller then culls nothing. The map does not depend on the
  /// number of threads.
  static std::unique_ptr<GaugeMap> build(InnerPolytope polytope, const GaugeSettings& settings);
  static std::unique_ptr<GaugeMap> build(InnerPolytope polytope, unsigned resolution = 0,
                                         std::uint32_t most_nodes = 0) {
    return build(std::move(polytope),
                 GaugeSettings{.resolution = resolution, .most_nodes = most_nodes});
  }

  /// For an exact hull in space with so few facets, outward oriented, that testing every node
  /// against all of them is faster than walks. Returns null where build() would.
  static std::unique_ptr<GaugeMap> of_few_facets(const InnerPolytope& polytope,
                                                 unsigned resolution);

  /// Ids (ascending, indices into `points`) of all points that are not provably strictly inside the
  /// polytope; a point with a NaN or an infinity is always among them.
  /// `rows`: gets their coordinates, if given.
  std::vector<std::uint64_t> survivors(const PointView& points, const Run& run,
                                       SurvivorRows* rows = nullptr) const;

  /// Of packed rows of finite points those that are not provably strictly inside the polytope, by
  /// the facet each one's ray leaves by: a slower test than survivors(), but exact up to rounding.
  /// Positions, ascending; those `certain` are among them without being asked about. Needs a map
  /// built with cones.
  std::vector<std::uint64_t> outside_cones(const Array<double>& rows,
                                           const std::vector<char>& certain, const Run& run) const;

  /// The same test of one point.
  bool inside_cones(const double* row) const;

  /// What the kernels read.
  const GaugeTable& table() const noexcept;

  ~GaugeMap();

 private:
  struct Table;
  explicit GaugeMap(std::unique_ptr<Table> table);
  std::unique_ptr<Table> table_;
};

}  // namespace cullhull::internal::inline filter
