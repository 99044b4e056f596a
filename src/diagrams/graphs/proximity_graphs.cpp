#include "cullhull/proximity_graphs.hpp"

#include <algorithm>
#include <cmath>
#include <unordered_set>
#include <vector>

#include "diagrams/dual.hpp"
#include "exact/numbers/double_double.hpp"
#include "exact/orientation/difference_products.hpp"
#include "parallel/disjoint_sets.hpp"
#include "parallel/memory/pages.hpp"
#include "parallel/threads/checked_steps.hpp"

namespace cullhull::internal {
namespace {

void write_edges(const std::vector<Edge>& edges, Array<std::uint32_t>& out) {
  out.reserve(2 * edges.size());
  for (const Edge& e : edges) {
    out.push_back(e.low);
    out.push_back(e.high);
  }
}

// ------------------------------------------------------------------------- the spanning tree

struct MeasuredEdge {
  DoubleDouble size;  ///< the squared length, rounded
  Edge edge;
  bool exact;  ///< `size` is not rounded
};

/// Sorts edges by length, then by ids. Squared lengths in double-doubles are compared exactly only
/// where they are too close, so that the order is that of the exact lengths.
class EdgeOrder {
 public:
  EdgeOrder(const DualPoints& p, unsigned d) : p_(p), d_(d) {}

  /// The squared length. It is exact if only one coordinate differs, or if all squares and sums are
  /// doubles.
  MeasuredEdge measure(const Edge& e) const {
    MeasuredEdge m{{}, e, true};
    for (unsigned j = 0; j < d_; ++j) {
      const DoubleDouble x = DoubleDouble::sum(p_.row(e.low)[j], -p_.row(e.high)[j]);
      if (x.high == 0) continue;
      const DoubleDouble square = x * x;
      m.exact = m.exact && x.low == 0 && square.high >= 0x1p-900 && square.high <= 0x1p900;
      if (m.size.high == 0) {
        m.size = square;
        continue;
      }
      m.exact = m.exact && m.size.low == 0 && square.low == 0;
      m.size = m.size + square;
    }
    if (!(m.size.high <= 0x1p1000)) m = {DoubleDouble(INFINITY), e, false};  // overflow
    return m;
  }

  void sort(std::vector<MeasuredEdge>& edges, const Run& run) const {
    constexpr std::uint32_t exact_step = 64;  // an exact comparison takes as long as many steps
    CheckedSteps steps(run);
    std::sort(edges.begin(), edges.end(), [&](const MeasuredEdge& a, const MeasuredEdge& b) {
      const bool rounded = (a.exact && b.exact) || apart(a, b);
      steps.next(rounded ? 1 : exact_step);
      if (rounded) {
        if (a.size.high != b.size.high) return a.size.high < b.size.high;
        return a.size.low != b.size.low ? a.size.low < b.size.low : a.edge < b.edge;
      }
      const Sign sign = compare_lengths(d_, p_.row(a.edge.low), p_.row(a.edge.high),
                                        p_.row(b.edge.low), p_.row(b.edge.high));
      return sign != Sign::zero ? sign == Sign::negative : a.edge < b.edge;
    });
  }

 private:
  /// Whether the difference of two lengths is more than twice the error of both, 2^-101 per
  /// operation. False if they overflowed.
  bool apart(const MeasuredEdge& a, const MeasuredEdge& b) const {
    const double most = std::max(a.size.high, b.size.high);
    const double doubt = (4.0 * d_ + 16) * 0x1p-101 * most + 0x1p-890;
    return std::abs((b.size.high - a.size.high) + (b.size.low - a.size.low)) > doubt;
  }

  const DualPoints& p_;
  unsigned d_;
};

// ------------------------------------------------------------------ Gabriel and lunes of points

/// Whether no point that shares a cell with the edge is in the closed ball whose diameter is the
/// edge.
bool ball_is_empty(const DualPoints& p, const Triangulation& t, const EdgeCells::Star& e) {
  const double *a = p.row(e.low), *b = p.row(e.high);
  for (const auto& item : e.cells)
    for (const std::uint32_t v : t.cell(item.cell)) {
      if (v == e.low || v == e.high) continue;
      const double* r = p.row(v);
      const DifferenceProduct term{1, a, r, b, r};
      if (sign_of_products(t.dimension, {&term, 1}) != Sign::positive) return false;
    }
  return true;
}

std::vector<Edge> gabriel_edges(const DualPoints& p, const Triangulation& t,
                                const Adjacency<std::uint32_t>& stars, const Run& run) {
  const EdgeCells edges(t, stars);
  std::vector<Edge> all;
  constexpr std::uint64_t grain = light_grain / 16;
  std::vector<std::vector<Edge>> parts(chunk_count(t.point_count, grain));
  run.each_chunk(t.point_count, grain,
                 [&](std::uint64_t chunk, std::uint64_t begin, std::uint64_t end) {
    edges.each_edge(begin, end, [&](const EdgeCells::Star& e) {
      if (ball_is_empty(p, t, e)) parts[chunk].push_back(e);
    });
  });
  for (const std::vector<Edge>& part : parts) all.insert(all.end(), part.begin(), part.end());
  return all;
}

/// The points that share an edge with each point, ascending.
Lists<std::uint32_t> point_neighbours(const Triangulation& t, const Adjacency<std::uint32_t>& stars,
                                      const Run& run) {
  ChunkedListBuilder lists(t.point_count);
  run.each_chunk(t.point_count, lists.grain,
                 [&](std::uint64_t chunk, std::uint64_t begin, std::uint64_t end) {
    std::vector<std::uint32_t> list;
    for (std::uint64_t v = begin; v < end; ++v) {
      list.clear();
      for (const std::uint32_t c : stars[v])
        for (const std::uint32_t w : t.cell(c))
          if (w != v) list.push_back(w);
      std::sort(list.begin(), list.end());
      list.erase(std::unique(list.begin(), list.end()), list.end());
      lists.add(chunk, list);
    }
  });
  return lists.join(run);
}

/// Searches the lune of an edge: the points nearer to both ends than these are to each other.
class LuneSearch {
 public:
  LuneSearch(const DualPoints& p, const Lists<std::uint32_t>& graph, unsigned d)
      : p_(p), graph_(graph), d_(d) {}

  /// Whether the lune is empty. Searches from both ends in turn: the points that are nearer to an
  /// end than the other end is are connected to it in the triangulation. The search is complete
  /// once one end has no more such points.
  bool empty(const Edge& e) {
    edge_ = e;
    for (Side& side : sides_) side.clear();
    // A point in the lune usually is a neighbour of both ends.
    if (!expand(sides_[0], e.low, e.low, e.high) || !expand(sides_[1], e.high, e.high, e.low))
      return false;
    for (;;)
      for (unsigned i = 0; i < 2; ++i) {
        if (sides_[i].todo.empty()) return true;
        const std::uint32_t v = sides_[i].todo.back();
        sides_[i].todo.pop_back();
        if (!expand(sides_[i], v, i == 0 ? e.low : e.high, i == 0 ? e.high : e.low)) return false;
      }
  }

 private:
  /// Points visited from one end: a list, searched linearly, while they are few, then a hash table.
  struct Side {
    static constexpr std::size_t few = 32;
    std::vector<std::uint32_t> todo, met;
    std::unordered_set<std::uint32_t> many;

    void clear() {
      todo.clear();
      met.clear();
      if (!many.empty()) many.clear();
    }
    bool meet(std::uint32_t v) {
      if (met.size() < few) {
        if (std::find(met.begin(), met.end(), v) != met.end()) return false;
        met.push_back(v);
        return true;
      }
      return std::find(met.begin(), met.end(), v) == met.end() && many.insert(v).second;
    }
  };
  /// Whether the distance of v from `end` is less than the length of the edge.
  bool nearer(std::uint32_t v, std::uint32_t end) const {
    return compare_lengths(d_, p_.row(v), p_.row(end), p_.row(edge_.low), p_.row(edge_.high)) ==
           Sign::negative;
  }
  /// Visits the neighbours of v; false if one of them is in the lune.
  bool expand(Side& side, std::uint32_t v, std::uint32_t own, std::uint32_t other) {
    for (const std::uint32_t next : graph_[v]) {
      if (next == other || next == own || !nearer(next, own)) continue;
      if (nearer(next, other)) return false;
      if (side.meet(next)) side.todo.push_back(next);
    }
    return true;
  }

  const DualPoints& p_;
  const Lists<std::uint32_t>& graph_;  ///< point_neighbours()
  unsigned d_;
  Edge edge_{};
  Side sides_[2];
};

std::vector<Edge> spanning_edges(const DualPoints& p, const Triangulation& t, const Run& run) {
  const EdgeOrder order(p, t.dimension);
  std::vector<MeasuredEdge> edges;
  CheckedSteps steps(run);
  if (t.corners() > 1) {
    const Adjacency<std::uint32_t> stars = stars_of(t, run);
    EdgeCells(t, stars).each_edge(0, t.point_count, [&](const EdgeCells::Star& e) {
      steps.next();
      edges.push_back(order.measure(e));
    });
  }
  run.report("sort", 0.3);
  order.sort(edges, run);
  run.check();
  DisjointSets joined(t.point_count);
  joined.clear(0, t.point_count);
  std::vector<Edge> tree;
  for (const DuplicatePoint& twin : t.duplicates) tree.push_back({twin.representative, twin.id});
  for (const MeasuredEdge& m : edges) {
    steps.next();
    if (joined.root(m.edge.low) == joined.root(m.edge.high)) continue;
    joined.join(m.edge.low, m.edge.high);
    tree.push_back(m.edge);
  }
  std::sort(tree.begin(), tree.end(), [&](const Edge& a, const Edge& b) {
    steps.next();
    return a < b;
  });
  return tree;
}

std::vector<Edge> lune_edges(const DualPoints& p, const Triangulation& t, const Run& run) {
  std::vector<Edge> edges, candidates;
  Lists<std::uint32_t> graph;
  {
    const Adjacency<std::uint32_t> stars = stars_of(t, run);
    candidates = gabriel_edges(p, t, stars, run);
    if (candidates.empty()) return edges;
    run.report("lunes", 0.5);
    graph = point_neighbours(t, stars, run);
  }
  Array<std::uint8_t> kept(candidates.size());
  run.each(candidates.size(), 256, [&](std::uint64_t begin, std::uint64_t end) {
    LuneSearch search(p, graph, t.dimension);
    for (std::uint64_t i = begin; i < end; ++i) kept[i] = search.empty(candidates[i]) ? 1 : 0;
  });
  for (std::size_t i = 0; i < candidates.size(); ++i)
    if (kept[i] != 0) edges.push_back(candidates[i]);
  return edges;
}

/// The common part of the public functions: checks, then edges_of(points, triangulation, run).
template <class EdgesOf>
Array<std::uint32_t> graph_of(const PointView& points, const Triangulation& t,
                              const RunOptions& options, const EdgesOf& edges_of) {
  require_unweighted(t, "graphs of near points");
  const Call call(options);
  const Run& run = call.run;
  const DualPoints p(points, t, {}, run);
  Array<std::uint32_t> out;
  write_edges(edges_of(p, t, run), out);
  run.report("done", 1);
  return out;
}

}  // namespace
}  // namespace cullhull::internal

namespace cullhull {

using namespace internal;

Array<std::uint32_t> minimum_spanning_tree(const PointView& points,
                                           const Triangulation& triangulation,
                                           const RunOptions& options) {
  return graph_of(points, triangulation, options, spanning_edges);
}

Array<std::uint32_t> gabriel_graph(const PointView& points, const Triangulation& triangulation,
                                   const RunOptions& options) {
  return graph_of(points, triangulation, options,
                  [](const DualPoints& p, const Triangulation& t, const Run& run) {
    return gabriel_edges(p, t, stars_of(t, run), run);
  });
}

Array<std::uint32_t> relative_neighbourhood_graph(const PointView& points,
                                                  const Triangulation& triangulation,
                                                  const RunOptions& options) {
  return graph_of(points, triangulation, options, lune_edges);
}

}  // namespace cullhull
