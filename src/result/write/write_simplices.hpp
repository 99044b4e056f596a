// Writes the canonical result of hulls in general position, where every simplex is a facet, and the
// lists of vertices that all writers share.
#pragma once

#include <cstddef>
#include <cstdint>
#include <numeric>
#include <vector>

#include "hull/engine.hpp"
#include "hull/space/triangle_mesh.hpp"
#include "parallel/memory/raw_array.hpp"
#include "parallel/threads/run.hpp"
#include "result/boundary.hpp"
#include "result/build_hull.hpp"
#include "result/measures/measure_frame.hpp"

namespace cullhull::internal::inline result {

// The points that a surface uses, numbered by ascending id.

/// Positions among the vertices ascend as the local ids do.
struct VertexList {
  std::vector<std::uint64_t> ids;     ///< point ids, ascending
  bool all_points = false;            ///< every local point is a vertex: position = local id
  bool plain = false;                 ///< and its id too
  BigArray<std::uint32_t> positions;  ///< of local ids that are vertices; empty if all are

  std::uint32_t position(std::uint32_t local) const {
    return all_points ? local : positions[local];
  }
};

/// `ids`: point id of each of `points` local ones; nullptr: the same.
VertexList list_vertices(const Boundary& surface, std::uint32_t points, const std::uint64_t* ids,
                         const Run& run);

// Ranks of flagged items.

/// `flags`: 0 or 1 for each of `count` items. Calls prepare(total) with the number of ones, then,
/// if that returns true, visit(item, rank) for every item, `rank` being the number of flagged items
/// before it. Two passes over the flags, in parallel chunks.
template <class Prepare, class Visit>
void rank_flagged(const std::uint8_t* flags, std::uint64_t count, const Run& run,
                  const Prepare& prepare, const Visit& visit) {
  std::vector<std::uint32_t> start(chunk_count(count, light_grain) + 1, 0);
  run.each_chunk(count, light_grain, [&](std::uint64_t c, std::uint64_t begin, std::uint64_t end) {
    start[c + 1] = std::accumulate(flags + begin, flags + end, std::uint32_t{0});
  });
  for (std::size_t c = 1; c < start.size(); ++c) start[c] += start[c - 1];
  if (!prepare(start.back())) return;
  run.each_chunk(count, light_grain, [&](std::uint64_t c, std::uint64_t begin, std::uint64_t end) {
    std::uint32_t rank = start[c];
    for (std::uint64_t i = begin; i < end; ++i) {
      visit(i, rank);
      rank += flags[i];
    }
  });
}

// The extreme points of an engine's boundary.

/// Ascending rows of the extreme points (of equal points the lowest); `boundary` as build_hull
/// takes it. Adds to `rung_counts`.
std::vector<std::uint64_t> extreme_rows(Boundary&& boundary, const LocalPoints& points,
                                        const Run& run, std::uint64_t* rung_counts);

/// Ascending rows of a polygon's corners among `count` rows, or their ids (which ascend) if not
/// null.
std::vector<std::uint64_t> ascending_ids(const std::uint32_t* corners, std::size_t size,
                                         std::uint32_t count, const std::uint64_t* ids,
                                         const Run& run);

// The result in 3D where every triangle is a facet: points in general position.

/// Checks every ridge and fills the hull in a few sweeps over the engine's own facets. Returns
/// false, with surface and hull unchanged but for their counts of rungs, where the general code is
/// needed: some facets are coplanar, the points span too many powers of two, or the surface is not
/// that of a hull. Otherwise the surface is consumed. The points must have dimension 3.
bool write_triangles(const ResultInput& input, TriangleMesh& surface, const Run& run, Hull& hull);

/// For k = 4 ... 8 = surface.dimension and a frame that is not wild: checks every ridge of the
/// surface, as `coplanar_pairs` does, and fills the hull from it in a few sweeps. Returns false,
/// with the hull's facets and measures unchanged, where some simplices are coplanar, so that the
/// general code is needed. `vertices`: those of the surface; hull.vertices must hold their ids.
/// `key_bits`: length of the sorting keys, at most 128; tests pass less to reach the code for keys
/// that do not hold all vertices.
bool write_simplices(const ResultInput& input, const Boundary& surface, const VertexList& vertices,
                     const Frame& frame, const Run& run, Hull& hull, unsigned key_bits = 128);

}  // namespace cullhull::internal::inline result
