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
#include "parallel/prefetch.hpp"
#include "parallel/scan.hpp"
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

/// Joins the items that chunks of a loop have collected, in the order of the chunks; they are
/// moved.
template <class Part, class T>
Array<T> join_items(std::vector<Part>& parts, std::vector<T> Part::*items, const Run& run) {
  std::vector<std::uint64_t> before;
  for (const Part& part : parts) before.push_back((part.*items).size());
  Array<T> all(exclusive_scan(before));
  run.each_item(parts.size(), [&](std::uint64_t p) {
    const std::vector<T> own = std::move(parts[p].*items);
    std::copy(own.begin(), own.end(), all.begin() + static_cast<std::ptrdiff_t>(before[p]));
  });
  return all;
}
/// The same for lists. `ends`: where each list ends in its chunk's items; of the first chunk there
/// is a zero before these.
template <class Part>
Lists<std::uint32_t> join_lists(std::vector<Part>& parts, std::vector<std::uint32_t> Part::*items,
                                std::vector<std::uint64_t> Part::*ends, const Run& run) {
  std::vector<std::uint64_t> before;
  for (const Part& part : parts) before.push_back((part.*items).size());
  exclusive_scan(before);
  run.each_item(parts.size(), [&](std::uint64_t p) {
    for (std::uint64_t& end : parts[p].*ends) end += before[p];
  });
  return {join_items(parts, ends, run), join_items(parts, items, run)};
}

/// Collects lists from the chunks of a parallel loop and joins them in the order of the chunks.
class ChunkedListBuilder {
 public:
  explicit ChunkedListBuilder(std::uint64_t count)
      : grain(light_grain / 16), parts_(std::max<std::uint64_t>(1, chunk_count(count, grain))) {
    parts_[0].ends.push_back(0);
  }

  void add(std::uint64_t chunk, std::span<const std::uint32_t> list) {
    Part& part = parts_[chunk];
    part.items.insert(part.items.end(), list.begin(), list.end());
    part.ends.push_back(part.items.size());
  }
  Lists<std::uint32_t> join(const Run& run) {
    return join_lists(parts_, &Part::items, &Part::ends, run);
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

/// The cells around each point, ascending.
inline Adjacency<std::uint32_t> stars_of(const Triangulation& t, const Run& run) {
  return rows_by_id(t.cells, t.corners(), t.point_count, run);
}

/// For each point the edges to higher points, each with the cells around it.
class EdgeCells {
 public:
  /// Refers to the triangulation and its stars.
  EdgeCells(const Triangulation& t, const Adjacency<std::uint32_t>& stars) : t_(t), stars_(stars) {}

  /// A cell at an edge, and the edge's higher point.
  struct Item {
    std::uint32_t cell, high;
  };
  /// An edge and the cells around it, ascending.
  struct Star : Edge {
    std::span<const Item> cells;
  };
  /// Calls body(star) for each edge whose lower point is in [begin, end), in lexicographic order.
  template <class Body>
  void each_edge(std::uint64_t begin, std::uint64_t end, const Body& body) const {
    std::vector<Item> room;
    for (std::uint64_t v = begin; v < end; ++v) {
      for (const std::uint32_t c : stars_[std::min(v + 1, end - 1)])
        prefetch_line(t_.cell(c).data());
      room.resize(stars_[v].size() * t_.corners());
      std::size_t count = 0;
      for (const std::uint32_t c : stars_[v])
        for (const std::uint32_t w : t_.cell(c)) {  // branch-free, as it is unpredictable
          room[count] = {c, w};
          count += w > v ? 1 : 0;
        }
      const std::span<Item> around(room.data(), count);
      std::sort(around.begin(), around.end(), [](const Item& a, const Item& b) {
        return (std::uint64_t{a.high} << 32 | a.cell) < (std::uint64_t{b.high} << 32 | b.cell);
      });
      for (std::size_t i = 0; i < around.size();) {
        std::size_t next = i + 1;
        while (next < around.size() && around[next].high == around[i].high) ++next;
        body(Star{{static_cast<std::uint32_t>(v), around[i].high}, around.subspan(i, next - i)});
        i = next;
      }
    }
  }

 private:
  const Triangulation& t_;
  const Adjacency<std::uint32_t>& stars_;
};

/// The first cell of each group; empty if every cell is a group of its own.
Array<std::uint32_t> first_cells(const Triangulation& t);
/// Writes the vertices of `out`. Requires k >= 1.
void write_vertices(const DualPoints& p, const Triangulation& t, Voronoi& out, const Run& run);
/// Writes the ridges of `out`; for k = 2 also the regions. `stars`: stars_of(), for k != 2.
void write_ridges(const DualPoints& p, const Triangulation& t,
                  const Adjacency<std::uint32_t>& stars, Voronoi& out, const Run& run);

}  // namespace cullhull::internal
