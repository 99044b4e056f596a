#include <algorithm>
#include <atomic>
#include <bit>

#include "cullhull/hull.hpp"
#include "parallel/index.hpp"
#include "parallel/memory/raw_array.hpp"
#include "parallel/prefetch.hpp"
#include "parallel/radix_sort.hpp"
#include "parallel/scan.hpp"
#include "parallel/threads/parallel.hpp"
#include "result/boundary.hpp"
#include "result/write/write_simplices.hpp"

namespace cullhull::internal {
namespace {

/// Sorts the simplices into canonical order and fills all lists of the hull.
class FacetOrderer {
 public:
  FacetOrderer(const ResultInput& input, Facets&& facets, const Run& run, Hull& hull)
      : input_(input),
        facets_(std::move(facets)),
        surface_(facets_.surface),
        k_(surface_.dimension),
        count_(surface_.facet_count()),
        run_(run),
        hull_(hull) {}

  OrderedFacets run() {
    vertices_ = list_vertices(surface_, input_.local->count, input_.ids, run_);
    hull_.vertices = vertices_.ids;
    sort_simplices();
    number_facets();
    write_simplices();
    write_facets();
    return {std::move(vertices_.ids), std::move(vertex_index_)};
  }

 private:
  /// Sorting key of a simplex.
  struct Key {
    std::uint64_t rest;  // the ids after the first, as many as fit; k <= 3: 32 bits each
    std::uint32_t first, simplex;
  };

  template <class Body>
  void each_chunk(std::uint64_t begin, std::uint64_t end, const Body& body) const {
    run_.each_chunk(end - begin, simplex_chunk,
                    [&](std::uint64_t c, std::uint64_t from, std::uint64_t to) {
      body(c, begin + from, begin + to);
    });
  }

  /// Compares two simplices with the same first id.
  bool less(const Key& a, const Key& b) const {
    if (a.rest != b.rest) return a.rest < b.rest;
    for (unsigned j = packed_; j < k_; ++j) {
      const std::uint32_t x = surface_.stored(a.simplex, j), y = surface_.stored(b.simplex, j);
      if (x != y) return x < y;
    }
    return false;
  }

  /// Sorts the simplices by their first id, then those with the same first id by their other ids.
  void sort_simplices() {
    BigArray<Key> memory(count_), other(count_);
    const auto bits = static_cast<unsigned>(std::bit_width(input_.local->count));
    const unsigned each = k_ > 3 ? bits : 32;
    packed_ = std::min(k_, 1 + 64 / each);
    each_chunk(0, count_, [&](std::uint64_t, std::uint64_t begin, std::uint64_t end) {
      for (std::uint64_t f = begin; f < end; ++f) {
        std::uint64_t rest = 0;
        for (unsigned j = 1; j < packed_; ++j) rest = rest << each | surface_.stored(f, j);
        if (k_ == 2) rest <<= each;
        memory[f] = {rest, surface_.stored(f, 0), static_cast<std::uint32_t>(f)};
      }
    });
    Key *keys = memory.get(), *scratch = other.get();
    radix_sort(keys, scratch, static_cast<std::uint32_t>(count_), bits, run_,
               [](const Key& k) { return k.first; });
    // The simplices of a vertex with many thousands of them (as in a facet with many corners) are
    // sorted by all threads together.
    constexpr std::uint64_t many = 1 << 14;
    std::vector<std::vector<std::pair<std::uint64_t, std::uint64_t>>> long_runs(
        chunk_count(count_, simplex_chunk));
    // The position where the first run (of equal first ids) that begins in each chunk begins. It is
    // computed before any run is sorted.
    std::vector<std::uint64_t> starts(long_runs.size() + 1, count_);
    each_chunk(0, count_, [&](std::uint64_t c, std::uint64_t begin, std::uint64_t) {
      std::uint64_t i = begin;
      while (i > 0 && i < count_ && keys[i].first == keys[i - 1].first) ++i;
      starts[c] = i;
    });
    each_chunk(0, count_, [&](std::uint64_t c, std::uint64_t, std::uint64_t) {
      const std::uint64_t last = starts[c + 1];
      for (std::uint64_t at = starts[c]; at < last;) {
        std::uint64_t to = at + 1;
        while (to < last && keys[to].first == keys[at].first) ++to;
        if (to - at > many && k_ <= 3)
          long_runs[c].emplace_back(at, to);
        else if (to - at > 1)
          std::sort(keys + at, keys + to,
                    [this](const Key& a, const Key& b) { return less(a, b); });
        at = to;
      }
    });
    for (const auto& runs : long_runs)
      for (const auto& [begin, end] : runs) sort_long_run(keys, scratch, begin, end, bits);
    resize_big(order_, count_);
    resize_big(rank_, count_);
    each_chunk(0, count_, [&](std::uint64_t, std::uint64_t begin, std::uint64_t end) {
      for (std::uint64_t i = begin; i < end; ++i) {
        order_[i] = keys[i].simplex;
        rank_[keys[i].simplex] = static_cast<std::uint32_t>(i);
      }
    });
  }

  /// Sorts a run of equal first ids, k <= 3, by stable sorts: by the third id, then by the second.
  void sort_long_run(Key* keys, Key* scratch, std::uint64_t begin, std::uint64_t end,
                     unsigned bits) const {
    Key *items = keys + begin, *other = scratch + begin;
    const auto n = static_cast<std::uint32_t>(end - begin);
    radix_sort(items, other, n, bits, run_,
               [](const Key& k) { return static_cast<std::uint32_t>(k.rest); });
    radix_sort(items, other, n, bits, run_,
               [](const Key& k) { return static_cast<std::uint32_t>(k.rest >> 32); });
    if (items == keys + begin) return;
    each_chunk(begin, end, [&](std::uint64_t, std::uint64_t from, std::uint64_t to) {
      std::copy(scratch + from, scratch + to, keys + from);
    });
  }

  std::uint64_t id(std::uint32_t local) const { return input_.ids ? input_.ids[local] : local; }

  /// Numbers the facets in the order of their first simplices in canonical order. Without merged
  /// facets, facet i is simplex i.
  void number_facets() {
    if (facets_.facet.empty()) {
      hull_.simplex_facets = EvenArray<std::uint32_t>::of_step(count_, 1);
      return;
    }
    const std::size_t singles = facets_.singles, n = singles + facets_.vertices.size();
    BigArray<std::uint32_t> first(n);  // first simplex of each facet, in canonical order
    each_chunk(0, n, [&](std::uint64_t, std::uint64_t begin, std::uint64_t end) {
      for (std::uint64_t f = begin; f < end; ++f) first[f] = f < singles ? rank_[f] : no_index;
    });
    each_chunk(singles, count_, [&](std::uint64_t, std::uint64_t begin, std::uint64_t end) {
      for (std::uint64_t f = begin; f < end;) {  // the simplices of a facet are consecutive
        const std::uint32_t facet = facets_.facet[f];
        std::uint32_t lowest = no_index;
        for (; f < end && facets_.facet[f] == facet; ++f) lowest = std::min(lowest, rank_[f]);
        const std::atomic_ref<std::uint32_t> so_far(first[facet]);
        std::uint32_t now = so_far.load(std::memory_order_relaxed);
        while (lowest < now &&
               !so_far.compare_exchange_weak(now, lowest, std::memory_order_relaxed)) {
        }
      }
    });
    const auto begins_facet = [&](std::uint64_t i) { return first[facets_.facet[order_[i]]] == i; };
    facet_rank_ = BigArray<std::uint32_t>(n);
    facet_order_ = BigArray<std::uint32_t>(n);
    pack(
        count_, simplex_chunk, run_, begins_facet, [](std::uint64_t) { return true; },
        [&](std::uint64_t i, std::uint64_t number) {
      const std::uint32_t facet = facets_.facet[order_[i]];
      facet_rank_[facet] = static_cast<std::uint32_t>(number);
      facet_order_[number] = facet;
        });
    Array<std::uint32_t> numbers(count_);
    each_chunk(0, count_, [&](std::uint64_t, std::uint64_t begin, std::uint64_t end) {
      for (std::uint64_t i = begin; i < end; ++i)
        numbers[i] = facet_rank_[facets_.facet[order_[i]]];
    });
    hull_.simplex_facets = std::move(numbers);
  }

  void write_simplices() {
    Array<std::uint64_t> simplices(count_ * k_);
    resize_big(hull_.simplex_neighbours, count_ * k_);
    resize_big(vertex_index_, count_ * k_);
    each_chunk(0, count_, [&](std::uint64_t, std::uint64_t begin, std::uint64_t end) {
      for (std::uint64_t i = begin; i < end; ++i) {
        prefetch(i);
        const std::uint32_t f = order_[i];
        const std::uint32_t* ids = surface_.simplex(f);
        const std::uint32_t* next = surface_.neighbours.data() + std::size_t{f} * k_;
        for (unsigned j = 0; j < k_; ++j) {
          const unsigned slot = surface_.stored_slot(f, j);
          simplices[i * k_ + j] = id(ids[slot]);
          vertex_index_[i * k_ + j] = vertices_.position(ids[slot]);
          hull_.simplex_neighbours[i * k_ + j] = rank_[next[slot]];
        }
      }
    });
    hull_.simplices = std::move(simplices);
  }

  /// Prefetches simplices, and nearer ahead the data they refer to: consecutive simplices of the
  /// canonical order are scattered in memory.
  void prefetch(std::uint64_t i) const {
    if (i + 32 >= count_) return;
    const std::size_t far = std::size_t{order_[i + 32]} * k_,
                      near = std::size_t{order_[i + 16]} * k_;
    prefetch_line(surface_.vertices.data() + far);
    prefetch_line(surface_.neighbours.data() + far);
    prefetch_line(surface_.odd.data() + order_[i + 32]);
    for (unsigned j = 0; j < k_; ++j) {
      if (!vertices_.all_points) prefetch_line(&vertices_.positions[surface_.vertices[near + j]]);
      prefetch_line(rank_.data() + surface_.neighbours[near + j]);
    }
  }

  /// Writes the vertices and neighbours of all facets.
  void write_facets() {
    if (facets_.facet.empty()) {
      write_simplicial_facets();
      return;
    }
    const std::size_t n = facets_.singles + facets_.vertices.size();
    Array<std::uint64_t> offsets =
        offsets_of([this](std::size_t m) { return length(facets_.vertices, m); });
    Array<std::uint64_t> neighbour_offsets =
        offsets_of([this](std::size_t m) { return length(facets_.neighbours, m); });
    Array<std::uint64_t> items(offsets[n]);
    hull_.facet_neighbours.items.resize(neighbour_offsets[n]);
    each_chunk(0, n, [&](std::uint64_t, std::uint64_t begin, std::uint64_t end) {
      for (std::uint64_t i = begin; i < end; ++i) {
        std::uint64_t* vertices = items.data() + offsets[i];
        std::uint32_t* across = hull_.facet_neighbours.items.data() + neighbour_offsets[i];
        const std::uint32_t facet = facet_order_[i];
        if (facet < facets_.singles) {
          write_vertices(rank_[facet], vertices);
          write_neighbours(rank_[facet], across);
        } else {
          write_merged(facet - facets_.singles, vertices, across);
        }
      }
    });
    hull_.facets = {std::move(offsets), std::move(items)};
    hull_.facet_neighbours.offsets = std::move(neighbour_offsets);
  }

  /// The offsets of lists in the facets' order. The list of an unmerged facet has k items, that of
  /// merged facet m has merged_length(m).
  template <class Length>
  Array<std::uint64_t> offsets_of(const Length& merged_length) const {
    const std::size_t n = facets_.singles + facets_.vertices.size();
    Array<std::uint64_t> offsets(n + 1);
    const auto sums = sum_chunks<std::uint64_t>(n, simplex_chunk, run_,
                                                [&](std::uint64_t begin, std::uint64_t end) {
      std::uint64_t sum = 0;
      for (std::uint64_t i = begin; i < end; ++i) {
        const std::uint32_t facet = facet_order_[i];
        offsets[i] = sum;
        sum += facet < facets_.singles ? k_ : merged_length(facet - facets_.singles);
      }
      return sum;
    });
    each_chunk(0, n, [&](std::uint64_t c, std::uint64_t begin, std::uint64_t end) {
      for (std::uint64_t i = begin; i < end; ++i) offsets[i] += sums.before[c];
    });
    offsets[n] = sums.total;
    return offsets;
  }

  template <class T>
  static std::size_t length(const Lists<T>& lists, std::size_t i) {
    return lists.offsets[i + 1] - lists.offsets[i];
  }

  /// Writes the facets of a hull without merged facets.
  void write_simplicial_facets() {
    const bool shared = facets_are_simplices(k_);
    Array<std::uint64_t> items(shared ? 0 : count_ * k_);
    Array<std::uint32_t> neighbours(count_ * k_);
    each_chunk(0, count_, [&](std::uint64_t, std::uint64_t begin, std::uint64_t end) {
      for (std::uint64_t i = begin; i < end; ++i) {
        if (!shared) write_vertices(i, items.data() + i * k_);
        write_neighbours(i, neighbours.data() + i * k_);
      }
    });
    using Ids = SharedArray<std::uint64_t>;
    hull_.facets =
        Lists<std::uint64_t, Ids>::of_length(k_, shared ? hull_.simplices : Ids(std::move(items)));
    hull_.facet_neighbours = Lists<std::uint32_t>::of_length(k_, std::move(neighbours));
  }

  /// Writes the vertices of the facet that consists of simplex i of the canonical order alone.
  void write_vertices(std::uint64_t i, std::uint64_t* vertices) const {
    const std::uint64_t* ids = hull_.simplices.data() + i * k_;
    for (unsigned j = 0; j < k_; ++j) vertices[j] = ids[k_ == 2 ? 1 - j : j];
    if (k_ > 3 && vertices[k_ - 2] > vertices[k_ - 1])
      std::swap(vertices[k_ - 2], vertices[k_ - 1]);
  }
  void write_neighbours(std::uint64_t i, std::uint32_t* across) const {
    const std::uint32_t* next = hull_.simplex_neighbours.data() + i * k_;
    for (unsigned j = 0; j < k_; ++j)  // k = 3: the edge from vertex j is opposite to vertex j + 2
      across[j] = hull_.simplex_facets[next[k_ == 2 ? 1 - j : k_ == 3 ? (j + 2) % 3 : j]];
    if (k_ > 3) std::sort(across, across + k_);
  }

  /// Writes the vertices and neighbours of merged facet m.
  void write_merged(std::size_t m, std::uint64_t* vertices, std::uint32_t* across) const {
    const auto& v = facets_.vertices;
    for (std::size_t i = v.offsets[m]; i < v.offsets[m + 1]; ++i) *vertices++ = id(v.items[i]);
    const auto& n = facets_.neighbours;
    std::uint32_t* out = across;
    for (std::size_t i = n.offsets[m]; i < n.offsets[m + 1]; ++i) *out++ = facet_rank_[n.items[i]];
    if (k_ > 3) std::sort(across, out);
  }

  const ResultInput& input_;
  Facets facets_;
  const Boundary& surface_;
  const unsigned k_;
  unsigned packed_ = 0;  // the ids of a simplex that its key holds
  const std::size_t count_;
  const Run& run_;
  Hull& hull_;
  VertexList vertices_;
  std::vector<std::uint32_t> order_, rank_;           // canonical to old, old to canonical
  BigArray<std::uint32_t> facet_rank_, facet_order_;  // old to canonical, and back
  std::vector<std::uint32_t> vertex_index_;
};

}  // namespace

OrderedFacets order_facets(const ResultInput& input, Facets&& facets, const Run& run, Hull& hull) {
  return FacetOrderer(input, std::move(facets), run, hull).run();
}

}  // namespace cullhull::internal
