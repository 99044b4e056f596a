// The parts of a hull that are drawn: its vertices, its edges, and the triangles of a surface.
#pragma once

#include <cstdint>
#include <vector>

#include "cullhull/hull_fwd.hpp"

namespace cullhull::viewer {

struct ShapeLimits {
  std::uint64_t vertices = 0;
  std::uint64_t edges = 0;  ///< limit for hulls of dimension 4 and more
};

struct HullShape {
  /// Positions in hull.vertices, ascending unless all vertices are drawn.
  std::vector<std::uint64_t> vertices;
  /// Pairs and triples of positions in `vertices` above.
  std::vector<std::uint32_t> edges;
  std::vector<std::uint32_t> triangles;
  /// For each triangle the facet that contains it; empty unless all of a 3D hull is drawn.
  std::vector<std::uint32_t> facets;
  /// True if edges and triangles are those of the hull of the chosen vertices alone.
  bool simplified = false;
  /// True if some edges between the chosen vertices are missing.
  bool edges_sampled = false;
};

/// `most` of the numbers below `count`, ascending, each with (nearly) the same probability: one
/// from each of `most` equal ranges, at a reproducible pseudorandom position, so that a period in
/// the file's order does not show. All numbers if `most` >= `count`.
std::vector<std::uint64_t> fair_sample(std::uint64_t count, std::uint64_t most);

/// The shape of a hull whose vertices have these coordinates (rows of hull.dimension, in the order
/// of hull.vertices). Edges are those of maximal facets, without the diagonals of their
/// triangulation. Full-dimensional hulls of dimension 2 and 3 have triangles, hulls of higher
/// dimension edges only. Beyond the limits: up to dimension 3 the hull of a uniform sample of the
/// vertices, above that a uniform sample of the edges between sampled vertices.
HullShape hull_shape(const Hull& hull, const std::vector<double>& rows, const ShapeLimits& limits);

/// The projection of a hull of dimension 4 or more onto three of its axes: the hull of the
/// projected vertices. Edges and triangles are positions in `vertices`, as in a HullShape.
struct Shadow {
  std::uint32_t axes[3];
  std::vector<std::uint32_t> edges, triangles;
};
/// The projections on every three of the first `axes` axes. `rows`: `dimension` numbers for each of
/// the hull's vertices; `vertices`: positions of those that are drawn.
std::vector<Shadow> shadows(const std::vector<double>& rows, std::uint32_t dimension,
                            const std::vector<std::uint64_t>& vertices, std::uint32_t axes);

}  // namespace cullhull::viewer
