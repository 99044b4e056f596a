// Many small hulls in one call.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "cullhull/hull_fwd.hpp"
#include "cullhull/lists.hpp"
#include "cullhull/options.hpp"
#include "cullhull/point_view.hpp"

#pragma GCC visibility push(default)
namespace cullhull {

/// The hulls of many sets, concatenated. Every list holds what the member of the same name in Hull
/// holds, set after set; ids count from the set's first point, facet and simplex numbers from the
/// set's first facet and simplex.
struct HullBatch {
  std::uint32_t dimension = 0;
  ScalarType scalar = ScalarType::f64;
  std::vector<std::uint64_t> point_counts;
  std::vector<std::int32_t> affine_dimensions;
  std::vector<double> volumes, areas;
  std::vector<double> centroids;  ///< sets x dimension; zeros for an empty set

  Lists<std::uint64_t> vertices;               ///< one list per set
  std::vector<std::uint64_t> facet_starts{0};  ///< set i: facets [facet_starts[i], ...[i + 1])
  Lists<std::uint64_t> facets;                 ///< one list per facet
  Lists<std::uint32_t> facet_neighbours;       ///< one list per facet
  Array<double> facet_planes;                  ///< facets x (dimension + 1)
  Lists<std::uint64_t> simplices;              ///< one list per set, k ids per simplex
  Lists<std::uint32_t> simplex_neighbours;     ///< as `simplices`
  Lists<std::uint32_t> simplex_facets;         ///< one list per set

  std::size_t size() const noexcept { return point_counts.size(); }
  /// Set i alone: equal to the result of convex_hull, except for `statistics`. Throws
  /// Error{invalid_argument} if there is no set i.
  Hull hull(std::size_t i) const;
};

/// The exact hulls of the sets [offsets[i], offsets[i + 1]) of `points`: the same results as one
/// convex_hull call per set, for any number of threads. `offsets`: an entry more than there are
/// sets, ascending, at most points.count; else Error{invalid_argument}. The error of the first set
/// that has one is thrown, and names the set and the point within it. options.cull and
/// options.backend apply to large sets; small ones are not filtered. One thread computes each set,
/// so this is for many small sets; for a few large ones, convex_hull on each uses the cores better.
/// Thread safe; memory O(results + points of the sets computed at the same time).
HullBatch convex_hulls(const PointView& points, std::span<const std::uint64_t> offsets,
                       const Options& options = {});

}  // namespace cullhull
#pragma GCC visibility pop
