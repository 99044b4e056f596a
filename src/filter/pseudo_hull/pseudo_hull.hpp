// PseudoHull: the filter of Tang, Zhao, Tong, Manocha, "GPU accelerated Convex Hull Computation",
// Computers & Graphics 36(5), 2012 (docs/algorithm.md, docs/exactness.md).
#pragma once

#include <cstdint>
#include <vector>

#include "cullhull/point_view.hpp"

namespace cullhull::internal {

struct Run;
/// The outcome of one round, summed over the subsets.
struct PseudoHullRound {
  std::uint64_t facets = 0;    ///< facets with an exterior set, each replaced by d others
  std::uint64_t exterior = 0;  ///< points in those sets before the round
  std::uint64_t culled = 0;    ///< points proved strictly inside; in round 0 by the first simplex
  std::uint64_t kept = 0;      ///< points that become survivors: apexes, and points in doubt
};

struct PseudoHullSettings {
  /// Number of subsets; each grows its own pseudo-hull. 0: 64, fewer if they would be too small to
  /// be worthwhile, more if they would exceed the cache. 1: all threads work on one.
  unsigned subsets = 0;
  /// Points still outside after this many rounds survive. A ball takes 13 to 16 rounds; only sets
  /// where each apex leaves all other points outside take many more.
  unsigned max_rounds = 100;
};

/// For each culled point a simplex of points that strictly contains it.
struct SimplexRecord {
  std::vector<std::uint32_t> simplex_of;  ///< by point; no_item (primitives.hpp) if it survived
  std::vector<std::uint64_t> corners;     ///< simplices x (d + 1) points
};

/// The most points of a subset: cells of the facet stream have 32-bit numbers.
inline constexpr std::uint64_t pseudo_hull_most_points = std::uint64_t{1} << 28;

/// Returns the ids (ascending, indices into `points`) of all points that are not provably strictly
/// inside the hull; a point with a NaN or an infinity is always among them. `rounds`, if given,
/// receives one entry for the first simplex and one for each round; `record` receives the simplex
/// that culled each point. None of them depends on the number of threads.
/// Time O(n d^2) a round for the points left, memory O(threads n / subsets + survivors).
std::vector<std::uint64_t> pseudo_hull_survivors(const PointView& points,
                                                 const PseudoHullSettings& settings, const Run& run,
                                                 std::vector<PseudoHullRound>* rounds = nullptr,
                                                 SimplexRecord* record = nullptr);

}  // namespace cullhull::internal
