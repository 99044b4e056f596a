#include "result/build_hull.hpp"

#include <algorithm>
#include <atomic>
#include <numeric>

#include "parallel/big_array.hpp"
#include "parallel/pages.hpp"
#include "parallel/parallel.hpp"
#include "result/measure.hpp"
#include "result/merge.hpp"
#include "result/simplicial.hpp"
#include "result/vertex_list.hpp"

namespace cullhull::internal {
namespace {

constexpr std::uint32_t none = 0xFFFFFFFFU;

/// k = 2: vertices counter-clockwise from the lowest id. Facet i runs from its vertex 0 to its
/// vertex 1; the vertices ascend before.
void wind_vertices(Hull& hull) {
  std::uint32_t facet = 0;
  while (hull.facets.items[2 * std::size_t{facet}] != hull.vertices[0]) ++facet;
  for (std::uint64_t& v : hull.vertices) {
    v = hull.facets.items[2 * std::size_t{facet}];
    facet = hull.facet_neighbours.items[2 * std::size_t{facet}];
  }
}

/// The same for edges that follow one another as the engine left them, which is seldom otherwise;
/// false if they do not. Walking the facets misses the cache at every step.
bool wind_along(const Surface& surface, const std::uint64_t* ids, unsigned threads, Hull& hull) {
  const std::uint64_t n = surface.count();
  // Outward edges run clockwise: from their second stored end, if seen counter-clockwise.
  const auto from = [&](std::uint64_t f) { return surface.stored(f, 1); };
  const auto to = [&](std::uint64_t f) { return surface.stored(f, 0); };
  const bool forward = to(0) == from(1);
  std::atomic<bool> broken{false};
  std::atomic<std::uint64_t> first{0};
  const std::uint64_t lowest = hull.vertices[0];
  for_each_chunk(n, simplex_chunk, threads,
                 [&](std::uint64_t, std::uint64_t begin, std::uint64_t end) {
                   for (std::uint64_t f = begin; f < end; ++f) {
                     const std::uint64_t g = f + 1 < n ? f + 1 : 0;
                     if (forward ? to(f) != from(g) : from(f) != to(g)) broken = true;
                     if ((ids ? ids[from(f)] : from(f)) == lowest) first = f;
                   }
                 });
  if (broken) return false;
  for_each_chunk(n, simplex_chunk, threads,
                 [&](std::uint64_t, std::uint64_t begin, std::uint64_t end) {
                   for (std::uint64_t i = begin; i < end; ++i) {
                     std::uint64_t f = forward ? first + i : first + n - i;
                     if (f >= n) f -= n;
                     hull.vertices[i] = ids ? ids[from(f)] : from(f);
                   }
                 });
  return true;
}

/// Canonical order of the simplices and everything that follows from it.
class Assembler {
 public:
  Assembler(const ResultInput& input, Facets&& facets, unsigned threads, const Control& control,
            Hull& hull)
      : input_(input),
        facets_(std::move(facets)),
        surface_(facets_.surface),
        k_(surface_.k),
        count_(surface_.count()),
        threads_(threads),
        control_(control),
        hull_(hull) {}

  void run() {
    sort_simplices();
    control_.check();
    number_facets();
    write_simplices();
    control_.check();
    write_facets();
    if (k_ == 2) wind_vertices(hull_);
  }

  const std::vector<std::uint64_t>& ascending_vertices() const { return ascending_; }
  std::vector<std::uint32_t> take_vertex_index() { return std::move(vertex_index_); }

 private:
  struct Key {
    std::uint64_t rest;  // the second and third id
    std::uint32_t simplex;
  };

  /// Counting sort on the first id, then each bucket by the rest. Also lists the vertices.
  void sort_simplices() {
    const std::uint32_t points = input_.local->count;
    std::vector<std::uint32_t> start(std::size_t{points} + 1, 0);
    position_.assign(points, 0);
    for (std::size_t f = 0; f < count_; ++f) {
      ++start[surface_.stored(f, 0) + 1];
      for (unsigned j = 0; j < k_; ++j) position_[surface_.simplex(f)[j]] = 1;
    }
    std::partial_sum(start.begin(), start.end(), start.begin());
    BigArray<Key> keys(count_);
    for (std::size_t f = 0; f < count_; ++f) {
      const std::uint64_t second = k_ > 1 ? surface_.stored(f, 1) : 0;
      const std::uint64_t third = k_ > 2 ? surface_.stored(f, 2) : 0;
      keys[start[surface_.stored(f, 0)]++] = {second << 32 | third, static_cast<std::uint32_t>(f)};
    }  // start[v] is now the end of bucket v
    const auto less = [this](const Key& a, const Key& b) {
      if (a.rest != b.rest) return a.rest < b.rest;
      for (unsigned j = 3; j < k_; ++j) {
        const std::uint32_t x = surface_.stored(a.simplex, j), y = surface_.stored(b.simplex, j);
        if (x != y) return x < y;
      }
      return false;
    };
    for_each_chunk(points, simplex_chunk, threads_,
                   [&](std::uint64_t, std::uint64_t begin, std::uint64_t end) {
                     for (std::uint64_t v = begin; v < end; ++v) {
                       const std::uint32_t from = v == 0 ? 0 : start[v - 1];
                       if (start[v] - from > 1)
                         std::sort(keys.get() + from, keys.get() + start[v], less);
                     }
                   });
    resize_big(order_, count_);
    resize_big(rank_, count_);
    for (std::uint32_t i = 0; i < count_; ++i) {
      order_[i] = keys[i].simplex;
      rank_[keys[i].simplex] = i;
    }
    std::uint32_t vertex = 0;
    for (std::uint32_t p = 0; p < points; ++p) {
      if (!position_[p]) continue;
      position_[p] = vertex++;
      ascending_.push_back(id(p));
    }
    hull_.vertices = ascending_;
  }

  std::uint64_t id(std::uint32_t local) const { return input_.ids ? input_.ids[local] : local; }

  /// By the first simplex in canonical order. Without merging, facet i is simplex i.
  void number_facets() {
    if (facets_.facet.empty()) {
      hull_.simplex_facets = EvenArray<std::uint32_t>::of_step(count_, 1);
      return;
    }
    Array<std::uint32_t> numbers(count_);
    facet_rank_.assign(facets_.singles + facets_.vertices.size(), none);
    for (std::size_t i = 0; i < count_; ++i) {
      std::uint32_t& number = facet_rank_[facets_.facet[order_[i]]];
      if (number == none) {
        number = static_cast<std::uint32_t>(facet_order_.size());
        facet_order_.push_back(facets_.facet[order_[i]]);
      }
      numbers[i] = number;
    }
    hull_.simplex_facets = std::move(numbers);
  }

  void write_simplices() {
    Array<std::uint64_t> simplices(count_ * k_);
    resize_big(hull_.simplex_neighbours, count_ * k_);
    resize_big(vertex_index_, count_ * k_);
    for_each_chunk(count_, simplex_chunk, threads_,
                   [&](std::uint64_t, std::uint64_t begin, std::uint64_t end) {
                     for (std::uint64_t i = begin; i < end; ++i) {
                       prefetch(i);
                       const std::uint32_t f = order_[i];
                       const std::uint32_t* ids = surface_.simplex(f);
                       const std::uint32_t* next = surface_.neighbours.data() + std::size_t{f} * k_;
                       for (unsigned j = 0; j < k_; ++j) {
                         const unsigned slot = surface_.stored_slot(f, j);
                         simplices[i * k_ + j] = id(ids[slot]);
                         vertex_index_[i * k_ + j] = position_[ids[slot]];
                         hull_.simplex_neighbours[i * k_ + j] = rank_[next[slot]];
                       }
                     }
                   });
    hull_.simplices = std::move(simplices);
  }

  /// The old order knows nothing of the new: two steps of prefetching, records then what they name.
  void prefetch(std::uint64_t i) const {
    if (i + 32 >= count_) return;
    const std::size_t far = std::size_t{order_[i + 32]} * k_,
                      near = std::size_t{order_[i + 16]} * k_;
    __builtin_prefetch(surface_.ids.data() + far);
    __builtin_prefetch(surface_.neighbours.data() + far);
    __builtin_prefetch(surface_.odd.data() + order_[i + 32]);
    for (unsigned j = 0; j < k_; ++j) {
      __builtin_prefetch(position_.data() + surface_.ids[near + j]);
      __builtin_prefetch(rank_.data() + surface_.neighbours[near + j]);
    }
  }

  void write_facets() {
    if (facets_.facet.empty()) {
      write_simplicial_facets();
      return;
    }
    const std::size_t n = facet_order_.size();
    Array<std::uint64_t> offsets(n + 1, 0), neighbour_offsets(n + 1, 0);
    for (std::size_t i = 0; i < n; ++i) {
      const bool single = facet_order_[i] < facets_.singles;
      const std::size_t m = single ? 0 : facet_order_[i] - facets_.singles;
      offsets[i + 1] = offsets[i] + (single ? k_ : length(facets_.vertices, m));
      neighbour_offsets[i + 1] =
          neighbour_offsets[i] + (single ? k_ : length(facets_.neighbours, m));
    }
    Array<std::uint64_t> items(offsets[n]);
    hull_.facet_neighbours.items.resize(neighbour_offsets[n]);
    for (std::size_t i = 0; i < n; ++i) {
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
    hull_.facets = {std::move(offsets), std::move(items)};
    hull_.facet_neighbours.offsets = std::move(neighbour_offsets);
  }

  template <class T>
  static std::size_t length(const Lists<T>& lists, std::size_t i) {
    return lists.offsets[i + 1] - lists.offsets[i];
  }

  void write_simplicial_facets() {
    const bool shared = facets_are_simplices(k_);
    Array<std::uint64_t> items(shared ? 0 : count_ * k_);
    Array<std::uint32_t> neighbours(count_ * k_);
    for_each_chunk(count_, simplex_chunk, threads_,
                   [&](std::uint64_t, std::uint64_t begin, std::uint64_t end) {
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

  /// A facet that is simplex i of the canonical order.
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
  const Surface& surface_;
  const unsigned k_;
  const std::size_t count_;
  const unsigned threads_;
  const Control& control_;
  Hull& hull_;
  std::vector<std::uint32_t> order_, rank_;  // canonical to old and back
  std::vector<std::uint32_t> facet_rank_, facet_order_;
  std::vector<std::uint32_t> position_;  // local point to place among the vertices
  std::vector<std::uint64_t> ascending_;
  std::vector<std::uint32_t> vertex_index_;
};

}  // namespace

void build_hull(const ResultInput& input, SimplicialHull&& boundary, const Control& control,
                unsigned threads, Hull& hull) {
  hull.dimension = input.view->dimension;
  hull.point_count = input.view->count;
  hull.scalar = input.view->scalar;
  hull.affine_dimension = static_cast<int>(boundary.dimension);

  const PageScope pages;
  const LocalPoints& local = *input.local;
  control.report("surface", 0);
  Surface surface = make_surface(std::move(boundary), local, threads);
  if (surface.k > 1) {
    VertexList vertices = list_vertices(surface, local.count, input.ids, threads);
    if (build_simplicial(input, surface, vertices, threads, control, hull)) {
      hull.vertices = std::move(vertices.ids);
      if (surface.k == 2 && !wind_along(surface, input.ids, threads, hull)) wind_vertices(hull);
      return;
    }
  }
  control.report("merge", 0);
  std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs;
  if (surface.k > 1)
    pairs = coplanar_pairs(surface, local, threads, control, hull.statistics.rung_counts);
  Assembler assembler(input, merge_coplanar(std::move(surface), pairs, local, control), threads,
                      control, hull);
  assembler.run();
  control.report("measures", 0);
  measure(*input.view, assembler.ascending_vertices(), assembler.take_vertex_index(), input.axes,
          threads, control, hull);
}

}  // namespace cullhull::internal
