// Writers of the canonical result for points in general position, where every simplex is a facet;
// and the lists of vertices that all writers use.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "hull/engine.hpp"
#include "hull/space/triangle_mesh.hpp"
#include "parallel/memory/raw_array.hpp"
#include "result/boundary.hpp"
#include "result/build_hull.hpp"
#include "result/measures/measure_frame.hpp"

namespace cullhull::internal {

/// The vertices of a surface. A vertex's position is its rank by ascending id.
struct VertexList {
  std::vector<std::uint64_t> ids;     ///< point ids, ascending
  bool all_points = false;            ///< every local point is a vertex, so position = local id
  bool plain = false;                 ///< all_points, and point id = local id
  BigArray<std::uint32_t> positions;  ///< by local id of a vertex; empty if all_points

  std::uint32_t position(std::uint32_t local) const {
    return all_points ? local : positions[local];
  }
};

/// Lists the vertices of a surface. `points`: the number of local points; `ids`: the point id of
/// each local point, ascending; nullptr: its local id.
VertexList list_vertices(const Boundary& surface, std::uint32_t points, const std::uint64_t* ids,
                         const Run& run);

// The extreme points of an engine's boundary.

/// The rows of the extreme points, ascending; of equal points the lowest row. `boundary`: the same
/// input as build_hull's. Adds to `rung_counts`.
std::vector<std::uint64_t> extreme_rows(Boundary&& boundary, const LocalPoints& points,
                                        const Run& run, std::uint64_t* rung_counts);

/// The rows of a polygon's `size` corners among `count` rows, sorted; or, if `ids` is not null, the
/// ids of these rows, which ascend too.
std::vector<std::uint64_t> ascending_ids(const std::uint32_t* corners, std::size_t size,
                                         std::uint32_t count, const std::uint64_t* ids,
                                         const Run& run);

// The result in 3D if every triangle is a facet.

/// Checks every ridge and fills the hull in a few sweeps over the engine's own facets, and consumes
/// the surface. Returns false if the general code is needed: the points do not have dimension 3,
/// some facets are coplanar, the coordinates span too many powers of two, or the surface is not
/// that of a hull. Surface and hull are then unchanged, except for rung counts.
bool write_triangles(const ResultInput& input, TriangleMesh& surface, const Run& run, Hull& hull);

/// The same from 4D to 8D (surface.dimension) for a frame that is not wild: checks every ridge, as
/// coplanar_pairs does, and fills the hull in a few sweeps. Returns false, with the hull's facets
/// and measures unchanged, if some simplices are coplanar, so that the general code is needed.
/// `vertices`: those of the surface. `key_bits`: length of the sorting keys in bits, at most 128;
/// tests pass less to reach the code for keys that lack some vertices.
bool write_simplices(const ResultInput& input, const Boundary& surface, const VertexList& vertices,
                     const Frame& frame, const Run& run, Hull& hull, unsigned key_bits = 128);

/// A surface of few simplices of which no two adjacent ones are coplanar, as an engine that keeps
/// its memory leaves it.
struct FewSimplices {
  unsigned slots;                ///< some are empty: then their first neighbour is no_index
  const std::uint32_t* corners;  ///< slots x dimension points; outward as those of a Boundary
  const std::uint32_t* across;   ///< the slot of the simplex opposite to each of them

  bool live(unsigned f, unsigned dimension) const {
    return across[std::size_t{f} * dimension] != no_index;
  }
};

/// Fills the hull of `count` points of the view, those with the given ids (nullptr: 0, 1, ...), on
/// the calling thread, without checks. A simplex's key must fit 64 bits: the number of its slot and
/// its vertices. False, with the hull unchanged, where coordinates span too many powers of two.
bool write_few_simplices(const PointView& view, const std::uint64_t* ids, unsigned count,
                         const FewSimplices& surface, Hull& hull);

}  // namespace cullhull::internal
