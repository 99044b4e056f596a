// GaugeMap: the radial pseudo-hull laid on a cube map (docs/algorithm.md, docs/exactness.md).
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "control.hpp"
#include "cullhull/point_view.hpp"

namespace cullhull::internal {

struct GaugeTable;

/// A convex polytope whose vertices are input points: the pipeline hands it to the filter.
struct InnerPolytope {
  unsigned dimension = 0;
  /// Vertices, packed rows of exact input coordinates (untranslated, unscaled).
  std::vector<double> vertices;
  /// facets x d indices into vertices; oriented or not.
  std::vector<std::uint32_t> facets;
  /// facets x d: entry j is the facet across the ridge opposite to vertex j.
  std::vector<std::uint32_t> neighbours;
};

/// Immutable after construction; safe to share between threads.
class GaugeMap {
 public:
  static constexpr unsigned min_dimension = 2, max_dimension = 6;

  /// `resolution`: cells along an edge of the cube map; 0 chooses from the facet count, with at
  /// most `most_nodes` nodes (0: what a CPU's cache takes). Returns null when no useful map exists
  /// (the centre is not strictly inside in floating point, coordinates too extreme, ...): the
  /// caller then culls nothing.
  static std::unique_ptr<GaugeMap> build(const InnerPolytope& polytope, unsigned resolution = 0,
                                         std::uint32_t most_nodes = 0);

  /// Ids (ascending, indices into `points`) of all points that are not provably strictly inside the
  /// polytope; a point with a NaN or an infinity is always among them.
  std::vector<std::uint64_t> survivors(const PointView& points, unsigned threads,
                                       const Control& control) const;

  /// What the kernels read.
  const GaugeTable& table() const noexcept;

  ~GaugeMap();

 private:
  struct Table;
  explicit GaugeMap(std::unique_ptr<Table> table);
  std::unique_ptr<Table> table_;
};

}  // namespace cullhull::internal
