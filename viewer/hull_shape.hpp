// What of a hull can be drawn: its vertices, its edges, and the triangles of a surface.
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
  /// Not every edge between the chosen vertices is there.
  bool edges_sampled = false;
};

/// `most` of the numbers below `count`, ascending, each with (nearly) the same chance: one from
/// each of `most` equal ranges, where in its range is random but reproducible, so that no period in
/// the order of the file shows. All of them if `most` >= `count`.
std::vector<std::uint64_t> fair_sample(std::uint64_t count, std::uint64_t most);

/// The shape of a hull whose vertices have these coordinates (rows of hull.dimension in the order
/// of hull.vertices). Edges are those of maximal facets, never diagonals of their triangulation. A
/// hull of dimension 2 or 3 within its space has triangles; above there are edges only. Beyond the
/// limits: up to dimension 3 the hull of a fair sample of the vertices, above a fair sample of the
/// edges between sampled vertices.
HullShape hull_shape(const Hull& hull, const std::vector<double>& rows, const ShapeLimits& limits);

/// The shadow that chosen vertices of a hull of dimension 4 or more cast on three of their axes:
/// the hull of their projections. Edges and triangles name positions in `vertices`, as in a
/// HullShape.
struct Shadow {
  std::uint32_t axes[3];
  std::vector<std::uint32_t> edges, triangles;
};
/// On every three of the first `axes` axes. `rows` has `dimension` numbers for each of the hull's
/// vertices, `vertices` the positions of those that are drawn.
std::vector<Shadow> shadows(const std::vector<double>& rows, std::uint32_t dimension,
                            const std::vector<std::uint64_t>& vertices, std::uint32_t axes);

}  // namespace cullhull::viewer
