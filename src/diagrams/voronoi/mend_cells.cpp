// Makes the polygons of clipped 2D cells valid again where the rounding of corners has made rings
// cross or touch themselves. docs/exactness.md, "Clipped cells".
//
// * A cell's boundary is a set of directed edges with the cell on their left. A sweep with exact
//   signs looks for a corner on an edge, for edges that cross, and for points around which the
//   boundary turns other than 0 or 1 times; opposite edges cancel. Where it finds none, the edges
//   form polygons: rings touch each other in single points only. A convex ring needs no sweep.
//
// * A corner on an edge, and of two crossing edges the end nearest to the crossing, becomes a
//   corner of the (other) edge, in every cell that has the edge. With t the angle between the
//   edges, the distance of an end at r from the crossing to the other edge is r sin t: the least of
//   the four, so no more than that of the end that rounding moved across.
//
// * A part turned over by rounding has the longest edge of its ring led through one of its corners,
//   by which the part becomes thinner. Where no corner is nearer to both ends than they are to each
//   other (rings some units in the last place wide), the shortest edge is contracted.
//
// This ends: a lead replaces an edge by two that are earlier in the order by length, then ends
// (both parts at a crossing are shorter, by the triangle inequality: |ac| < |ax| + |xc| <= |ax| +
// |xb| for the end c of the other edge that is nearest to the crossing x), a contraction leaves
// fewer corners, and there are finitely many sets of edges between given corners. Since all cells
// with an edge change alike, their boundaries still add up to that of the region; with 0 or 1 turns
// around every point in each, no two overlap where the region's rounded boundary does not overlap
// itself. Corners are never moved and none is new: a ring may go through its neighbour's corner, as
// near as rounding.

#include <algorithm>
#include <bit>
#include <map>
#include <set>
#include <unordered_map>
#include <utility>

#include "diagrams/voronoi/cell_chain.hpp"
#include "parallel/threads/run.hpp"

namespace cullhull::internal {
namespace {

struct PointHash {
  std::size_t operator()(const RingPoint& x) const {
    // With + 0.0, as the two zeros are equal.
    const auto mixed = std::bit_cast<std::uint64_t>(x[0] + 0.0) * 0x9e3779b97f4a7c15U +
                       std::bit_cast<std::uint64_t>(x[1] + 0.0);
    return static_cast<std::size_t>((mixed ^ mixed >> 32) * 0xd6e8feb86659fd93U);
  }
};

class CellMender {
 public:
  CellMender(ClippedCells& cells, const Run& run) : cells_(cells), run_(run) {}

  void mend(const std::vector<std::uint32_t>& unsound) {
    for (std::set<std::uint32_t> open(unsound.begin(), unsound.end()); !open.empty();) {
      list_holders(open);
      std::set<std::uint32_t> touched;
      for (std::set<std::uint32_t> waiting = open; !waiting.empty();) {
        run_.check();
        const std::uint32_t cell = *waiting.begin();
        waiting.erase(waiting.begin());
        for (ChainMend m; (m = next_mend(chain(cell))).kind != ChainMend::Kind::none;)
          for (const std::uint32_t changed : apply(m))
            if (open.count(changed) == 0)
              touched.insert(changed);
            else if (changed != cell)
              waiting.insert(changed);
      }
      open.clear();
      for (const std::uint32_t cell : touched)
        if (next_mend(chain(cell)).kind != ChainMend::Kind::none) open.insert(cell);
    }
    name_neighbours();
    write();
  }

 private:
  /// Calls body(from, to, row) for the edges of a cell as it is listed.
  template <class Body>
  void each_edge(std::uint32_t cell, const Body& body) const {
    const auto at = [&](std::uint64_t row) {
      return RingPoint{cells_.vertices[2 * row], cells_.vertices[2 * row + 1]};
    };
    for (std::uint64_t r = cells_.polygon_rings[cells_.polygon_offsets[cell]];
         r < cells_.polygon_rings[cells_.polygon_offsets[cell + 1]]; ++r) {
      const std::uint64_t begin = cells_.ring_starts[r], end = cells_.ring_starts[r + 1];
      for (std::uint64_t v = begin; v < end; ++v) body(at(v), at(v + 1 < end ? v + 1 : begin), v);
    }
  }

  /// The edges of a cell that is changed, or about to be.
  CellChain& chain(std::uint32_t cell) {
    const auto found = chains_.try_emplace(cell);
    CellChain& edges = found.first->second;
    if (found.second)
      each_edge(cell, [&](const RingPoint& from, const RingPoint& to, std::uint64_t row) {
        edges.push_back({from, to, cells_.neighbours[row]});
      });
    return edges;
  }

  /// Lists for each corner that the given cells have or had all cells with that corner.
  void list_holders(const std::set<std::uint32_t>& of) {
    holders_.clear();
    for (const std::uint32_t cell : of) {
      for (const ChainEdge& e : chain(cell)) holders_[e.from];
      each_edge(cell, [&](const RingPoint& x, const auto&, auto) { holders_[x]; });
    }
    const auto add = [&](std::uint32_t cell, const RingPoint& x) {
      const auto place = holders_.find(x);
      if (place != holders_.end()) place->second.insert(cell);
    };
    for (std::uint32_t cell = 0; cell < cells_.point_count; ++cell) {
      if (cell % 65536 == 0) run_.check();
      if (chains_.count(cell) == 0)
        each_edge(cell, [&](const RingPoint& x, const auto&, auto) { add(cell, x); });
    }
    for (const auto& [cell, chain] : chains_)
      for (const ChainEdge& e : chain) add(cell, e.from);
  }

  /// Changes all cells alike; returns those that changed.
  std::vector<std::uint32_t> apply(const ChainMend& m) {
    std::vector<std::uint32_t> changed;
    const auto holds = [&](std::uint32_t cell) { return holders_[m.b].count(cell) != 0; };
    std::set<std::uint32_t> cells = holders_[m.a];
    if (m.kind == ChainMend::Kind::merge) cells.insert(holders_[m.b].begin(), holders_[m.b].end());
    for (const std::uint32_t cell : cells) {
      if (m.kind == ChainMend::Kind::through && !holds(cell)) continue;
      CellChain& edges = chain(cell);
      if (!change(m, edges)) continue;
      holders_[m.via].insert(cell);
      changed.push_back(cell);
    }
    return changed;
  }
  static bool change(const ChainMend& m, CellChain& edges) {
    bool changed = false;
    for (std::size_t i = 0, n = edges.size(); i < n; ++i) {
      ChainEdge& e = edges[i];
      if (m.kind == ChainMend::Kind::through) {
        if (std::minmax(e.from, e.to) != std::minmax(m.a, m.b)) continue;
        const ChainEdge rest{m.via, e.to, e.across};
        e.to = m.via;
        edges.push_back(rest);
        changed = true;
      } else {
        for (RingPoint* x : {&e.from, &e.to})
          if (*x != m.via && (*x == m.a || *x == m.b)) {
            *x = m.via;
            changed = true;
          }
      }
    }
    return changed;
  }

  /// Beyond some edges there is another cell now: the one that lists the opposite edge. If none
  /// does, that is the region's boundary, or still a cell too thin to have polygons.
  void name_neighbours() {
    std::set<std::uint32_t> changed;
    for (const auto& entry : chains_) changed.insert(entry.first);
    list_holders(changed);
    std::set<std::uint32_t> around;
    for (const auto& entry : holders_) around.insert(entry.second.begin(), entry.second.end());
    std::map<std::pair<RingPoint, RingPoint>, std::uint32_t> cell_of;
    const auto each = [&](std::uint32_t cell, const auto& body) {
      const auto place = chains_.find(cell);
      if (place != chains_.end())
        for (ChainEdge& e : place->second) body(e.from, e.to, e.across);
      else
        each_edge(cell, [&](const RingPoint& from, const RingPoint& to, std::uint64_t row) {
          body(from, to, cells_.neighbours[row]);
        });
    };
    for (const std::uint32_t cell : around)
      each(cell, [&](const RingPoint& from, const RingPoint& to, std::uint32_t) {
        if (holders_.count(from) != 0 && holders_.count(to) != 0)
          cell_of.emplace(std::pair(from, to), cell);
      });
    for (const std::uint32_t cell : around)
      each(cell, [&](const RingPoint& from, const RingPoint& to, std::uint32_t& across) {
        if (holders_.count(from) == 0 || holders_.count(to) == 0) return;
        const auto place = cell_of.find({to, from});
        if (place != cell_of.end())
          across = place->second;
        else if (across != no_index && has_polygons(across))
          across = no_index;
      });
  }

  bool has_polygons(std::uint32_t cell) const {
    const auto place = chains_.find(cell);
    return place != chains_.end() ? !place->second.empty()
                                  : cells_.polygon_offsets[cell] < cells_.polygon_offsets[cell + 1];
  }

  /// Lists the changed cells anew, and moves the others.
  void write() {
    ClippedCells out;
    out.dimension = 2;
    begin_lists(out);
    out.vertices.reserve(cells_.vertices.size());
    out.neighbours.reserve(cells_.neighbours.size());
    for (std::uint32_t cell = 0; cell < cells_.point_count; ++cell) {
      const auto place = chains_.find(cell);
      if (place == chains_.end())
        copy(cell, out);
      else
        add_polygons(polygons_of(place->second), out);
    }
    cells_.vertices = std::move(out.vertices);
    cells_.neighbours = std::move(out.neighbours);
    cells_.vertex_offsets = std::move(out.vertex_offsets);
    cells_.polygon_offsets = std::move(out.polygon_offsets);
    cells_.polygon_rings = std::move(out.polygon_rings);
    cells_.ring_starts = std::move(out.ring_starts);
  }
  void copy(std::uint32_t cell, ClippedCells& out) const {
    const std::uint64_t first = cells_.vertex_offsets[cell], last = cells_.vertex_offsets[cell + 1],
                        before = out.neighbours.size();
    for (std::uint64_t p = cells_.polygon_offsets[cell]; p < cells_.polygon_offsets[cell + 1];
         ++p) {
      for (std::uint64_t r = cells_.polygon_rings[p]; r < cells_.polygon_rings[p + 1]; ++r)
        out.ring_starts.push_back(cells_.ring_starts[r + 1] - first + before);
      out.polygon_rings.push_back(out.ring_starts.size() - 1);
    }
    out.vertices.insert(out.vertices.end(), cells_.vertices.begin() + 2 * first,
                        cells_.vertices.begin() + 2 * last);
    out.neighbours.insert(out.neighbours.end(), cells_.neighbours.begin() + first,
                          cells_.neighbours.begin() + last);
    out.polygon_offsets.push_back(out.polygon_rings.size() - 1);
    out.vertex_offsets.push_back(out.neighbours.size());
  }

  ClippedCells& cells_;
  const Run& run_;
  std::map<std::uint32_t, CellChain> chains_;
  std::unordered_map<RingPoint, std::set<std::uint32_t>, PointHash> holders_;
};

}  // namespace

void mend_cells(const std::vector<std::uint32_t>& unsound, ClippedCells& cells, const Run& run) {
  CellMender(cells, run).mend(unsound);
}

}  // namespace cullhull::internal
