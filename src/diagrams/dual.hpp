// Shared by the functions that compute a triangulation's dual: points as rows, lists built in
// chunks, edges with the cells around them.
#pragma once

#include <algorithm>
#include <compare>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "cullhull/array.hpp"
#include "cullhull/triangulation.hpp"
#include "cullhull/voronoi.hpp"
#include "exact/insphere/circumcentres.hpp"
#include "parallel/adjacency.hpp"
#include "parallel/threads/run.hpp"

namespace cullhull::internal {

/// Throws Error{invalid_argument} if points or weights are not those of the triangulation, or if
/// its lists have wrong sizes or hold ids or numbers that do not exist. So no list is read beyond
/// its end. Neighbours that are not mutual pass, which walks must allow for: throw bad_neighbours()
/// after more steps than there are cells.
void require_points_of(const Triangulation& t, const PointView& points,
                       std::span<const double> weights, const Run& run);

/// Throws Error{invalid_argument}: neighbours are not mutual, or a walk by them does not end.
[[noreturn]] void bad_neighbours();

/// Throws Error{invalid_argument} for furthest-site triangulations and hidden points. `what`: the
/// plural noun that the message begins with.
void require_unweighted(const Triangulation& t, const char* what);

/// All points as rows of d doubles, followed by the weight if there are weights.
class DualPoints {
 public:
  DualPoints(const PointView& points, const Triangulation& t, std::span<const double> weights,
             const Run& run);
  bool weighted() const { return weighted_; }
  const double* row(std::uint64_t i) const { return rows_.data() + i * stride_; }

 private:
  unsigned stride_;
  bool weighted_;
  Array<double> rows_;
};

/// Loads the corners of the cells [first, first + count), count <= centres_block, as the functions
/// of exact/insphere/circumcentres.hpp take them; cell_of(i): the ids of the corners of cell i.
/// Lanes beyond `count` get the last cell.
template <class CellOf>
void load_block(const DualPoints& p, unsigned k, std::uint64_t first, std::uint64_t count,
                const CellOf& cell_of, double* corners) {
  for (std::uint64_t lane = 0; lane < centres_block; ++lane) {
    const auto cell = cell_of(first + std::min(lane, count - 1));
    for (unsigned i = 0; i <= k; ++i) {
      const double* const row = p.row(cell[i]);
      for (unsigned j = 0; j < k; ++j) corners[(i * k + j) * centres_block + lane] = row[j];
    }
  }
}

/// Collects lists from the chunks of a parallel loop and joins them in the order of the chunks.
class ChunkedListBuilder {
 public:
  explicit ChunkedListBuilder(std::uint64_t count)
      : grain(light_grain / 16), parts_(chunk_count(count, grain)) {}

  void add(std::uint64_t chunk, const std::vector<std::uint32_t>& list) {
    Part& part = parts_[chunk];
    part.items.insert(part.items.end(), list.begin(), list.end());
    part.ends.push_back(part.items.size());
  }
  Lists<std::uint32_t> join() {
    std::uint64_t lists = 0, all = 0;
    for (const Part& part : parts_) {
      lists += part.ends.size();
      all += part.items.size();
    }
    Array<std::uint64_t> offsets;
    Array<std::uint32_t> items;
    offsets.reserve(lists + 1);
    offsets.push_back(0);
    items.reserve(all);
    for (Part& part : parts_) {
      const std::uint64_t before = items.size();
      items.insert(items.end(), part.items.begin(), part.items.end());
      for (const std::uint64_t end : part.ends) offsets.push_back(before + end);
      part = {};
    }
    return {std::move(offsets), std::move(items)};
  }
  const std::uint64_t grain;

 private:
  struct Part {
    std::vector<std::uint32_t> items;
    std::vector<std::uint64_t> ends;
  };
  std::vector<Part> parts_;
};

/// An edge as its points' ids, low < high; compared lexicographically.
struct Edge {
  std::uint32_t low, high;
  friend auto operator<=>(const Edge&, const Edge&) = default;
};

/// For each point the edges to higher points, each with the cells around it.
class EdgeCells {
 public:
  EdgeCells(const Triangulation& t, const Run& run);

  /// A cell at an edge, and the edge's higher point.
  struct Item {
    std::uint32_t high, cell;
  };
  /// An edge and the cells around it, ascending.
  struct Star : Edge {
    std::span<const Item> cells;
  };
  /// Calls body(star) for each edge whose lower point is in [begin, end), in lexicographic order.
  template <class Body>
  void each_edge(std::uint64_t begin, std::uint64_t end, const Body& body) const {
    for (std::uint64_t v = begin; v < end; ++v) {
      const std::span<const Item> around = items_[v];
      for (std::size_t i = 0; i < around.size();) {
        std::size_t next = i + 1;
        while (next < around.size() && around[next].high == around[i].high) ++next;
        body(Star{{static_cast<std::uint32_t>(v), around[i].high}, around.subspan(i, next - i)});
        i = next;
      }
    }
  }
  /// The number of points.
  std::uint64_t size() const { return items_.size(); }

 private:
  Adjacency<Item> items_;  ///< for each lower point; sorted by higher point, then by cell
};

/// The points that share an edge with each point, ascending.
Adjacency<std::uint32_t> point_neighbours(const EdgeCells& edges);

/// The first cell of each group; empty if every cell is a group of its own.
Array<std::uint32_t> first_cells(const Triangulation& t);
/// Writes the vertices of `out`. Requires k >= 1.
void write_vertices(const DualPoints& p, const Triangulation& t, Voronoi& out, const Run& run);
/// Writes the ridges of `out`; for k = 2 also the regions.
void write_ridges(const DualPoints& p, const Triangulation& t, Voronoi& out, const Run& run);

}  // namespace cullhull::internal
