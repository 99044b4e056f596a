// The boundary of a 2D cell as directed edges between rounded corners, and whether it is the
// boundary of polygons. docs/exactness.md, "Clipped cells".
#pragma once

#include <array>
#include <cstdint>
#include <utility>
#include <vector>

#include "cullhull/voronoi.hpp"
#include "diagrams/voronoi/clip_rings.hpp"

namespace cullhull::internal {

using RingPoint = std::array<double, 2>;

/// A directed edge, and the site across it (no_index: none). The cell is on its left.
struct ChainEdge {
  RingPoint from, to;
  std::uint32_t across;
};
/// The edges of all rings of a cell, in any order: as many end at each point as begin there.
using CellChain = std::vector<ChainEdge>;

/// A change that brings cells closer to polygons; all cells with edges at these points share it.
struct ChainMend {
  enum class Kind { none, through, merge } kind = Kind::none;
  RingPoint a{}, b{};
  RingPoint via{};  ///< through: edges between a and b go through it; merge: a and b become it
};

CellChain chain_of(const std::vector<CellPolygon>& polygons);

/// Removes pairs of opposite edges (spikes, slivers without area) and edges without length.
void cancel_opposite(CellChain& chain);

/// The next change that the chain needs; none if its edges meet only in common ends, and the number
/// of turns around every point is 0 or 1. Removes opposite edges first. Changes that are made until
/// none is left come to an end (docs/exactness.md).
ChainMend next_mend(CellChain& chain);

/// The polygons that a chain without further changes bounds, as join_pieces() lists them.
std::vector<CellPolygon> polygons_of(const CellChain& chain);

/// Whether all rings are simple and the polygons valid: they need no change.
bool sound(const std::vector<CellPolygon>& polygons);

/// Makes the polygons of clipped 2D cells valid again where the rounding of corners has made rings
/// cross or touch themselves. `unsound`: the cells with invalid polygons. Changes these and the
/// cells that share edges with them; every corner stays a corner of the diagram, rounded.
void mend_cells(const std::vector<std::uint32_t>& unsound, ClippedCells& cells, const Run& run);

}  // namespace cullhull::internal
