// Merging of coplanar triangles in 3D, where a merged facet is a polygon. All steps work on single
// ridges or facets, so they run on all threads. They take linear time, except that the borders'
// edges are sorted by facet.
#include <algorithm>
#include <atomic>
#include <bit>
#include <cstring>

#include "parallel/disjoint_sets.hpp"
#include "parallel/index.hpp"
#include "parallel/memory/raw_array.hpp"
#include "parallel/radix_sort.hpp"
#include "parallel/scan.hpp"
#include "parallel/threads/parallel.hpp"
#include "result/boundary.hpp"

namespace cullhull::internal {
namespace {

using Id = std::uint32_t;
constexpr std::memory_order relaxed = std::memory_order_relaxed;

/// A directed edge of a merged facet's border. Seen from outside the facet lies on its left.
struct Edge {
  Id facet;  // number of the merged facet, from 0
  Id from, to;
  Id simplex;  // the old simplex of the facet that has this edge
};

/// A side of a merged facet's polygon, between two of its corners: one edge, or several collinear
/// ones with flat (not extreme) vertices between them.
struct Side {
  Id across;  // the facet on the other side
  Edge first, last;
  Id corner() const { return first.from; }
};

/// Merges coplanar triangles to polygons and triangulates each by a fan from its lowest corner,
/// which is the pulling triangulation of a polygon.
class PolygonMerger {
 public:
  PolygonMerger(Boundary&& surface, const CoplanarPairs& pairs, const Run& run)
      : old_(std::move(surface)), pairs_(pairs), run_(run) {}

  Facets run() {
    number_facets();
    collect_borders();
    trace_borders();
    list_sides();
    write_surface();
    return std::move(out_);
  }

 private:
  std::uint64_t merged_count() const { return starts_.size() - 1; }
  bool is_large(std::uint64_t m) const { return starts_[m + 1] - starts_[m] > 1024; }
  bool single(Id facet) const { return facet < out_.singles; }
  Id across(Id f, unsigned slot) const { return old_.neighbours[std::size_t{f} * 3 + slot]; }

  // ------------------------------------------------------------------ which simplices, which edges

  /// Numbers the facets in facet_: first the unmerged simplices in their order, then the merged
  /// facets in the order of their first simplex.
  void number_facets() {
    const std::size_t n = old_.facet_count();
    DisjointSets sets(n);
    BigArray<std::uint8_t> merged(n);
    run_.each(n, simplex_chunk, [&](std::uint64_t begin, std::uint64_t end) {
      sets.clear(begin, end);
      std::memset(merged.get() + begin, 0, end - begin);
    });
    run_.each(pairs_.size(), simplex_chunk, [&](std::uint64_t begin, std::uint64_t end) {
      for (std::uint64_t i = begin; i < end; ++i) {
        const auto [a, b] = pairs_[i];
        sets.join(a, b);
        std::atomic_ref(merged[a]).store(1, relaxed);
        std::atomic_ref(merged[b]).store(1, relaxed);
      }
    });
    facet_ = BigArray<Id>(n);
    struct Count {
      Id singles = 0, roots = 0;
      void operator+=(const Count& o) { singles += o.singles, roots += o.roots; }
    };
    const auto counts =
        sum_chunks<Count>(n, simplex_chunk, run_, [&](std::uint64_t begin, std::uint64_t end) {
          Count count;
          for (std::uint64_t f = begin; f < end; ++f) {
            facet_[f] = merged[f] ? sets.root(static_cast<Id>(f)) : no_index;
            count.singles += facet_[f] == no_index;
            count.roots += facet_[f] == f;
          }
          return count;
        });
    const Id singles = counts.total.singles;
    out_.singles = singles;
    starts_.assign(counts.total.roots + std::size_t{1}, 0);
    BigArray<Id> number(n);  // of the roots
    run_.each_chunk(n, simplex_chunk, [&](std::uint64_t c, std::uint64_t begin, std::uint64_t end) {
      Count at = counts.before[c];
      for (std::uint64_t f = begin; f < end; ++f)
        if (facet_[f] == f) number[f] = singles + at.roots++;
    });
    run_.each_chunk(n, simplex_chunk, [&](std::uint64_t c, std::uint64_t begin, std::uint64_t end) {
      Count at = counts.before[c];
      for (std::uint64_t f = begin; f < end; ++f)
        facet_[f] = facet_[f] == no_index ? at.singles++ : number[facet_[f]];
    });
  }

  /// Collects the edges of all merged facets' borders, sorted by facet.
  void collect_borders() {
    const std::size_t n = old_.facet_count();
    const auto each_edge = [this](std::uint64_t f, const auto& body) {
      if (single(facet_[f])) return;
      for (unsigned j = 0; j < 3; ++j)
        if (facet_[across(static_cast<Id>(f), j)] != facet_[f]) body(j);
    };
    const auto sums = sum_chunks<std::uint64_t>(n, simplex_chunk, run_,
                                                [&](std::uint64_t begin, std::uint64_t end) {
      std::uint64_t count = 0;
      for (std::uint64_t f = begin; f < end; ++f) each_edge(f, [&](unsigned) { ++count; });
      return count;
    });
    edge_count_ = static_cast<Id>(sums.total);
    BigArray<Edge> memory(edge_count_), other(edge_count_);
    run_.each_chunk(n, simplex_chunk, [&](std::uint64_t c, std::uint64_t begin, std::uint64_t end) {
      Edge* out = memory.get() + sums.before[c];
      for (std::uint64_t f = begin; f < end; ++f)
        each_edge(f, [&](unsigned j) {
          const Id* v = old_.simplex(f);
          Id from = v[(j + 1) % 3], to = v[(j + 2) % 3];
          if (old_.odd[f]) std::swap(from, to);
          *out++ = {static_cast<Id>(facet_[f] - out_.singles), from, to, static_cast<Id>(f)};
        });
    });
    Edge *edges = memory.get(), *scratch = other.get();
    radix_sort(edges, scratch, edge_count_,
               static_cast<unsigned>(std::bit_width(merged_count() - 1)), run_,
               [](const Edge& e) { return e.facet; });
    edges_ = edges == memory.get() ? std::move(memory) : std::move(other);
    run_.each(edge_count_, simplex_chunk, [&](std::uint64_t begin, std::uint64_t end) {
      for (std::uint64_t i = begin; i < end; ++i)
        if (i == 0 || edges_[i - 1].facet != edges_[i].facet) starts_[edges_[i].facet] = i;
    });
    starts_.back() = edge_count_;
    for (std::uint64_t m = 0; m < merged_count(); ++m)
      if (starts_[m] >= starts_[m + 1]) fail_not_exact("a facet has too few corners");
  }

  // ------------------------------------------------------------------------------ around the
  // facets

  /// Finds the cyclic order of the edges of every merged facet: next_[i] is the position of the
  /// edge that follows edge i. Large facets are processed one after another, each by all threads;
  /// the others in parallel, each by one thread.
  void trace_borders() {
    next_ = BigArray<Id>(edge_count_);
    run_.each(merged_count(), 256, [&](std::uint64_t begin, std::uint64_t end) {
      for (std::uint64_t m = begin; m < end; ++m)
        if (!is_large(m)) find_next_of_few(starts_[m], starts_[m + 1]);
    });
    for (std::uint64_t m = 0; m < merged_count(); ++m)
      if (is_large(m)) find_next_of_many(starts_[m], starts_[m + 1]);
  }

  /// For the edges [begin, end) of a facet: sorts them by their start, and finds the next of each
  /// by binary search.
  void find_next_of_few(std::uint64_t begin, std::uint64_t end) {
    Edge* edges = edges_.get();
    std::sort(edges + begin, edges + end,
              [](const Edge& a, const Edge& b) { return a.from < b.from; });
    for (std::uint64_t i = begin; i < end; ++i) {
      const Edge* next = std::lower_bound(edges + begin, edges + end, edges[i].to,
                                          [](const Edge& e, Id v) { return e.from < v; });
      if (next == edges + end || next->from != edges[i].to ||
          (i > begin && edges[i - 1].from == edges[i].from))
        fail_not_exact("a facet's border is not one cycle");
      next_[i] = static_cast<Id>(next - edges);
    }
  }

  /// The same for a facet of many edges, on all threads. Each vertex of a border is the start of
  /// one edge and the end of one, so the list sorted by starts and the list sorted by ends
  /// correspond entry by entry.
  void find_next_of_many(std::uint64_t begin, std::uint64_t end) {
    struct End {
      Id vertex, edge;
    };
    const auto n = static_cast<Id>(end - begin);
    BigArray<End> memory(4 * std::size_t{n});
    End *from = memory.get(), *to = from + n, *scratch = to + n, *other = scratch + n;
    std::vector<Id> highest(chunk_count(n, simplex_chunk));
    run_.each_chunk(n, simplex_chunk, [&](std::uint64_t c, std::uint64_t b, std::uint64_t e) {
      Id most = 0;
      for (std::uint64_t i = b; i < e; ++i) {
        const Edge& edge = edges_[begin + i];
        from[i] = {edge.from, static_cast<Id>(begin + i)};
        to[i] = {edge.to, static_cast<Id>(begin + i)};
        most = std::max({most, edge.from, edge.to});
      }
      highest[c] = most;
    });
    const auto bits =
        static_cast<unsigned>(std::bit_width(*std::max_element(highest.begin(), highest.end())));
    const auto vertex = [](const End& e) { return e.vertex; };
    radix_sort(from, scratch, n, bits, run_, vertex);
    radix_sort(to, other, n, bits, run_, vertex);
    run_.each(n, simplex_chunk, [&](std::uint64_t b, std::uint64_t e) {
      for (std::uint64_t i = b; i < e; ++i) {
        if (from[i].vertex != to[i].vertex || (i > 0 && from[i - 1].vertex == from[i].vertex))
          fail_not_exact("a facet's border is not one cycle");
        next_[to[i].edge] = from[i].edge;
      }
    });
  }

  Id facet_across(const Edge& e) const { return facet_[across(e.simplex, slot_off(e))]; }

  /// Lists the sides of every merged facet, beginning at its lowest corner. A vertex of the border
  /// is extreme exactly if it lies on a third facet, that is, if the facets across its two edges
  /// differ.
  void list_sides() {
    sides_ = BigArray<Side>(edge_count_);
    std::vector<std::uint64_t> counts(merged_count() + 1, 0);  // the last stays 0 for the scan
    std::vector<std::uint64_t> large;
    for (std::uint64_t m = 0; m < merged_count(); ++m)
      if (is_large(m)) large.push_back(m);
    run_.each_chunk(large.size(), 1, [&](std::uint64_t i, std::uint64_t, std::uint64_t) {
      counts[large[i]] = list_sides(large[i]);
    });
    run_.each(merged_count(), 256, [&](std::uint64_t begin, std::uint64_t end) {
      for (std::uint64_t m = begin; m < end; ++m)
        if (!is_large(m)) counts[m] = list_sides(m);
    });
    // Compact the lists.
    const std::uint64_t total = exclusive_scan(counts);
    corner_starts_ = std::move(counts);
    BigArray<Side> close(total);
    out_.vertices.items.resize(total);
    out_.neighbours.items.resize(total);
    each_side([&](std::uint64_t m, std::uint64_t begin, std::uint64_t end) {
      for (std::uint64_t i = begin; i < end; ++i) {
        close[i] = sides_[starts_[m] + (i - corner_starts_[m])];
        out_.vertices.items[i] = close[i].corner();
        out_.neighbours.items[i] = close[i].across;
      }
    });
    sides_ = std::move(close);
    out_.vertices.offsets = Array<std::uint64_t>(corner_starts_.begin(), corner_starts_.end());
    out_.neighbours.offsets = out_.vertices.offsets;
  }

  /// Lists the sides of facet m in sides_, from the position of the facet's first edge on. Returns
  /// their number.
  std::uint64_t list_sides(std::uint64_t m) {
    const std::uint64_t begin = starts_[m], size = starts_[m + 1] - begin;
    Side* out = sides_.get() + begin;
    std::uint64_t count = 0, steps = 0, lowest = 0;
    // Begin at the start of a side, if there is one.
    Id start = static_cast<Id>(begin);
    for (Id facet = facet_across(edges_[start]); steps < size; ++steps) {
      start = next_[start];
      const Id next_facet = facet_across(edges_[start]);
      if (next_facet != facet) break;
    }
    Id last_facet = no_index;
    Id i = start;
    for (steps = 0; steps < size; ++steps, i = next_[i]) {
      if (steps % 65536 == 65535) run_.check();
      if (steps > 0 && i == start) fail_not_exact("a facet's border is not one cycle");
      const Edge& e = edges_[i];
      const Id facet = facet_across(e);
      if (facet != last_facet) {
        if (count > 0 && e.from < out[lowest].corner()) lowest = count;
        out[count++] = {facet, e, e};
        last_facet = facet;
      } else {
        out[count - 1].last = e;
      }
    }
    if (i != start) fail_not_exact("a facet's border is not one cycle");
    if (count < 3) fail_not_exact("a facet has too few corners");
    std::rotate(out, out + lowest, out + count);
    return count;
  }

  /// Calls body(facet, begin, end) in parallel for ranges of sides that together cover the sides of
  /// all merged facets. A facet's sides may be split between several calls.
  template <class Body>
  void each_side(const Body& body) const {
    run_.each(corner_starts_.back(), simplex_chunk, [&](std::uint64_t begin, std::uint64_t end) {
      auto at = std::upper_bound(corner_starts_.begin(), corner_starts_.end(), begin);
      while (begin < end) {
        const std::uint64_t stop = std::min(end, *at);
        body(static_cast<std::uint64_t>(at - corner_starts_.begin()) - 1, begin, stop);
        begin = stop;
        ++at;
      }
    });
  }

  // ------------------------------------------------------------------------------- the new surface

  /// The number of the first simplex of merged facet m's fan. A facet of n corners has n - 2
  /// simplices.
  Id first_simplex(std::uint64_t m) const {
    return static_cast<Id>(out_.singles + corner_starts_[m] - 2 * m);
  }
  /// The simplex of facet m's fan that has side s, of `count` sides, as an edge.
  Id simplex_at(std::uint64_t m, std::uint64_t s, std::uint64_t count) const {
    return first_simplex(m) + static_cast<Id>(s == 0 ? 0 : std::min(s - 1, count - 3));
  }

  /// The slot of the vertex of e.simplex that is off the edge e.
  unsigned slot_off(const Edge& e) const {
    const Id* v = old_.simplex(e.simplex);
    unsigned j = 0;
    while (j < 2 && (v[j] == e.from || v[j] == e.to)) ++j;
    return j;
  }

  /// Writes the new simplices. Neighbours are found by old edges: place_ maps the last edge of
  /// every side to the new simplex at that side, and the last edge of a side is the first edge of
  /// the same side seen from the neighbouring facet.
  void write_surface() {
    const std::uint64_t count = out_.singles + corner_starts_.back() - 2 * merged_count();
    if (count >= no_index) fail_not_exact("too many facets");
    Boundary& s = out_.surface;
    s.dimension = 3;
    resize_big(s.vertices, count * 3);
    resize_big(s.neighbours, count * 3);
    resize_big(s.odd, count);
    resize_big(out_.facet, count);
    place_ = BigArray<Id>(old_.facet_count() * 3);
    run_.each(old_.facet_count() * 3, simplex_chunk, [&](std::uint64_t begin, std::uint64_t end) {
      std::fill(place_.get() + begin, place_.get() + end, no_index);
    });
    each_side([&](std::uint64_t m, std::uint64_t begin, std::uint64_t end) {
      const std::uint64_t first = corner_starts_[m], sides = corner_starts_[m + 1] - first;
      for (std::uint64_t i = begin; i < end; ++i) {
        const Edge& e = sides_[i].last;
        place_[std::size_t{e.simplex} * 3 + slot_off(e)] = simplex_at(m, i - first, sides);
      }
    });
    run_.each(old_.facet_count(), simplex_chunk, [&](std::uint64_t begin, std::uint64_t end) {
      for (std::uint64_t f = begin; f < end; ++f)
        if (single(facet_[f])) write_single(static_cast<Id>(f));
    });
    each_side([&](std::uint64_t m, std::uint64_t begin, std::uint64_t end) {
      const std::uint64_t first = corner_starts_[m], sides = corner_starts_[m + 1] - first;
      for (std::uint64_t i = std::max(begin, first + 1); i < std::min(end, first + sides - 1); ++i)
        write_fan_simplex(m, i - first - 1, first, sides);
    });
  }

  /// The new simplex on the other side of slot j of old simplex f; that edge lies on a border.
  Id beyond(Id f, unsigned j) const {
    const Id g = across(f, j);
    if (single(facet_[g])) return facet_[g];
    const Id simplex = place_[std::size_t{g} * 3 + opposite_slot<3>(old_, f, j, g)];
    if (simplex == no_index) fail_not_exact("facets do not fit together");
    return simplex;
  }

  void write_single(Id f) {
    const Id number = facet_[f];  // facet `number` is simplex `number`
    Boundary& s = out_.surface;
    s.odd[number] = old_.odd[f];
    out_.facet[number] = number;
    for (unsigned j = 0; j < 3; ++j) {
      s.vertices[std::size_t{number} * 3 + j] = old_.simplex(f)[j];
      s.neighbours[std::size_t{number} * 3 + j] = beyond(f, j);
    }
  }

  /// Simplex t of facet m's fan: corners 0, t + 1 and t + 2.
  void write_fan_simplex(std::uint64_t m, std::uint64_t t, std::uint64_t first,
                         std::uint64_t sides) {
    const Side* side = sides_.get() + first;
    const auto outer = [&](std::uint64_t i) {
      const Edge& e = side[i].first;
      return beyond(e.simplex, slot_off(e));
    };
    const Id number = first_simplex(m) + static_cast<Id>(t);
    const Id a = side[t + 1].corner(), b = side[t + 2].corner();
    const Id opposite_a = t + 3 == sides ? outer(sides - 1) : number + 1;
    const Id opposite_b = t == 0 ? outer(0) : number - 1;
    Boundary& s = out_.surface;
    const bool odd = a > b;
    s.odd[number] = odd;
    out_.facet[number] = static_cast<Id>(out_.singles + m);
    Id* ids = s.vertices.data() + std::size_t{number} * 3;
    Id* next = s.neighbours.data() + std::size_t{number} * 3;
    ids[0] = side[0].corner();
    ids[1] = odd ? b : a;
    ids[2] = odd ? a : b;
    next[0] = outer(t + 1);
    next[1] = odd ? opposite_b : opposite_a;
    next[2] = odd ? opposite_a : opposite_b;
  }

  Boundary old_;
  const CoplanarPairs& pairs_;
  const Run& run_;
  Facets out_;
  BigArray<Id> facet_;                 // facet of each old simplex
  std::vector<std::uint64_t> starts_;  // first edge of each merged facet
  Id edge_count_ = 0;
  BigArray<Edge> edges_;
  BigArray<Id> next_;
  std::vector<std::uint64_t> corner_starts_;  // first side of each merged facet
  BigArray<Side> sides_;
  BigArray<Id> place_;  // new simplex for each old slot whose edge is a side's last
};

}  // namespace

Facets merge_polygons(Boundary&& surface, const CoplanarPairs& pairs, const Run& run) {
  return PolygonMerger(std::move(surface), pairs, run).run();
}

}  // namespace cullhull::internal
