// The parts of a hull that are drawn: its vertices, its edges, and the triangles of a surface.
#pragma once

#include <cstdint>
#include <vector>

#include "cullhull/hull.hpp"

namespace cullhull::viewer {

struct ShapeLimits {
  std::uint64_t vertices = 0;
  std::uint64_t edges = 0;  ///< for hulls of dimension 4 and more
};

struct HullShape {
  /// Positions in hull.vertices, ascending unless they are all.
  std::vector<std::uint64_t> vertices;
  /// Pairs and triples of positions in `vertices` above.
  std::vector<std::uint32_t> edges;
  std::vector<std::uint32_t> triangles;
  /// For each triangle the facet it is part of; empty unless a 3D hull is drawn whole.
  std::vector<std::uint32_t> facets;
  /// Edges and triangles are those of the hull of the chosen vertices alone.
  bool simplified = false;
  /// Some edges between the chosen vertices are missing.
  bool edges_sampled = false;
};

/// `most` of the numbers below `count`, ascending, each with (nearly) the same probability: one
/// from each of `most` equal ranges, at a reproducible pseudo-random place, so that a period in the
/// file's order does not show. All of them if `most` >= `count`.
std::vector<std::uint64_t> fair_sample(std::uint64_t count, std::uint64_t most);

/// The shape of a hull whose vertices have these coordinates (rows of hull.dimension in the order
/// of hull.vertices). Edges are those of maximal facets, without the diagonals of their
/// triangulation. A full-dimensional hull of dimension 2 or 3 has triangles; in higher dimensions
/// there are edges only. Beyond the limits: up to dimension 3 the hull of a uniform sample of the
/// vertices, above a uniform sample of the edges between sampled vertices.
HullShape hull_shape(const Hull& hull, const std::vector<double>& rows, const ShapeLimits& limits);

/// The projection of a hull of dimension 4 or more on three of its axes: the hull of the projected
/// vertices. Edges and triangles name positions in `vertices`, as in a HullShape.
struct Shadow {
  std::uint32_t axes[3];
  std::vector<std::uint32_t> edges, triangles;
};
/// On every three of the first `axes` axes. `rows` has `dimension` numbers for each of the hull's
/// vertices, `vertices` the positions of those that are drawn.
std::vector<Shadow> shadows(const std::vector<double>& rows, std::uint32_t dimension,
                            const std::vector<std::uint64_t>& vertices, std::uint32_t axes);

}  // namespace cullhull::viewer
