#include "delaunay/write_triangulation.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>
#include <utility>

#include "delaunay/lift_planes.hpp"
#include "exact/insphere/lift_side.hpp"
#include "geometry/simplex.hpp"
#include "parallel/adjacency.hpp"
#include "parallel/disjoint_sets.hpp"
#include "parallel/dispatch.hpp"
#include "parallel/index.hpp"
#include "parallel/prefetch.hpp"
#include "parallel/scan.hpp"
#include "parallel/threads/run.hpp"

namespace cullhull::internal {
namespace {

/// A facet between a kept cell and a cell that is not kept, or no cell.
struct OpenFacet {
  std::uint32_t cell, slot;
};
// Example: two triangles (0, 1, 2) and (1, 3, 2) have four open facets: all edges but 1-2. If only
// the first is kept, 1-2 is open as well, and is listed for the first triangle alone.

/// All of them in the order of cells. `kept`: a flag for each cell; null: all cells are kept.
std::vector<OpenFacet> open_facets(const Triangulation& t, const std::uint8_t* kept,
                                   const Run& run) {
  const std::uint32_t* across = t.neighbours.data();
  const std::uint64_t corners = t.corners();
  constexpr std::uint64_t chunk = light_grain;
  std::vector<std::vector<OpenFacet>> found(chunk_count(t.size(), chunk));
  run.each_chunk(t.size(), chunk, [&](std::uint64_t at, std::uint64_t begin, std::uint64_t end) {
    for (std::uint64_t i = begin * corners; i < end * corners; ++i) {
      const std::uint32_t o = across[i];
      if (o != no_index && (kept == nullptr || kept[o] != 0)) continue;
      const auto c = static_cast<std::uint32_t>(i / corners);
      if (kept == nullptr || kept[c] != 0)
        found[at].push_back({c, static_cast<std::uint32_t>(i % corners)});
    }
  });
  std::vector<OpenFacet> all;
  for (const auto& list : found) all.insert(all.end(), list.begin(), list.end());
  return all;
}

// Why buckets: a result of 20 million cells takes 640 MB; writing each cell straight to its sorted
// place would touch a new line of memory each time. Buckets of 2,048 lowest ids have some 14,000
// cells in 3D, 220 KB of corners, and are sorted in the second cache.

/// Writes the finite cells of a store, sorted by their vertices. Ids are not in spatial order, so
/// writing each cell to its sorted place would be a cache miss. Therefore the cells are copied
/// sequentially to buckets of consecutive lowest ids and sorted there, within the cache. Neighbours
/// are written in the order of the store, where neighbours are close to each other.
template <unsigned K>
class CellWriter {
 public:
  CellWriter(const LiftedPoints& s, CellStore<K>& store, Triangulation& out, const Run& run)
      : s_(s),
        store_(store),
        out_(out),
        run_(run),
        shift_(shift_of(out.point_count)),
        buckets_((out.point_count >> shift_) + 1) {}

  /// Returns for each cell of the store its number in the result; no_index except for finite ones.
  Array<std::uint32_t> write() {
    count_cells();
    out_.cells.resize(cells_.size() * corners());
    out_.neighbours.resize(cells_.size() * corners());
    clear_pages_early(out_.neighbours.data(), out_.neighbours.size() * 4, run_.threads,
                      [&] { run_.check(); });
    fill_buckets();
    run_.each_item(buckets_, [&](std::uint64_t b) { sort_bucket(b); });
    write_neighbours();
    return std::move(rank_);
  }

 private:
  static constexpr unsigned few_ids = 11;       // log2 of the ids per bucket: its cells fit a cache
  static constexpr unsigned most_buckets = 10;  // log2: as many streams are written at once

  static unsigned shift_of(std::uint64_t ids) {
    unsigned shift = few_ids;
    while (ids >> shift >> most_buckets > 0) ++shift;
    return shift;
  }
  constexpr unsigned corners() const { return K != 0 ? K + 1 : store_.corners(); }

  // Canonical order of a cell: corners ascend by id but for the last two, which are exchanged where
  // the permutation is odd, so that every cell stays positively oriented. Neighbours move with
  // their corners: neighbour j is opposite to corner j.

  /// Replaces the vertices of finite cells by the caller's ids, orders their corners and counts the
  /// cells of each bucket.
  void count_cells() {
    constexpr std::uint64_t most_chunks = 64;  // each has a counter for every bucket
    chunk_ = std::max<std::uint64_t>(light_grain, store_.count() / most_chunks + 1);
    begins_.assign(chunk_count(store_.count(), chunk_) * buckets_, 0);
    rank_.resize(store_.count());
    run_.each_chunk(store_.count(), chunk_,
                    [&](std::uint64_t chunk, std::uint64_t begin, std::uint64_t end) {
      std::uint32_t* const counts = begins_.data() + chunk * buckets_;
      for (std::uint64_t i = begin; i < end; ++i) {
        const auto c = static_cast<std::uint32_t>(i);
        if (store_.dead(c) || store_.ghost_slot(c) != corners()) {
          rank_[c] = no_index;
          continue;
        }
        std::uint32_t* v = store_.vertices(c);
        for (unsigned j = 0; j < corners(); ++j) v[j] = s_.ids[v[j]];
        sort_simplex<K == 0 ? 0 : K + 1, true>(v, store_.neighbours(c), corners());
        rank_[c] = 0;
        ++counts[v[0] >> shift_];
      }
    });
    scan_buckets(begins_, buckets_, &bucket_begins_);
    cells_.resize(bucket_begins_.back());
  }

  /// Copies the cells' vertices to their buckets, where the neighbours are written later.
  void fill_buckets() {
    std::uint32_t* const to = out_.neighbours.data();
    run_.each_chunk(store_.count(), chunk_,
                    [&](std::uint64_t chunk, std::uint64_t begin, std::uint64_t end) {
      std::uint32_t* const at = begins_.data() + chunk * buckets_;
      for (std::uint64_t i = begin; i < end; ++i) {
        const auto c = static_cast<std::uint32_t>(i);
        if (rank_[c] == no_index) continue;
        const std::uint32_t* v = store_.vertices(c);
        const std::uint32_t place = at[v[0] >> shift_]++;
        std::copy_n(v, corners(), to + std::size_t{place} * corners());
        cells_[place] = c;
      }
    });
  }

  /// A cell of a bucket, for sorting: its corners except the lowest one, and its place.
  struct Row {
    std::uint64_t key;         ///< corners 1 and 2
    std::uint32_t third, row;  ///< corner 3; the place
  };

  /// Writes a bucket's cells in their order, and numbers them.
  void sort_bucket(std::uint64_t bucket) {
    const std::uint32_t begin = bucket_begins_[bucket];
    const std::uint32_t count = bucket_begins_[bucket + 1] - begin;
    const std::uint32_t* const cells = out_.neighbours.data() + std::size_t{begin} * corners();
    const auto first = static_cast<std::uint32_t>(bucket << shift_);
    std::vector<std::uint32_t> ends(
        std::min<std::uint64_t>(std::uint64_t{1} << shift_, out_.point_count - first));
    for (std::uint32_t i = 0; i < count; ++i) ++ends[cells[std::size_t{i} * corners()] - first];
    std::uint32_t all = 0;
    for (std::uint32_t& end : ends) all += std::exchange(end, all);
    Array<Row> rows(count);
    for (std::uint32_t i = 0; i < count; ++i) {
      const std::uint32_t* v = cells + std::size_t{i} * corners();
      const std::uint64_t second = corners() > 2 ? v[2] : 0;
      rows[ends[v[0] - first]++] = {std::uint64_t{v[1]} << 32 | second, corners() > 3 ? v[3] : 0,
                                    i};
    }
    const auto less = [&](const Row& a, const Row& b) {
      if (a.key != b.key) return a.key < b.key;
      if (a.third != b.third || corners() <= 4) return a.third < b.third;
      const std::uint32_t *v = cells + std::size_t{a.row} * corners(),
                          *w = cells + std::size_t{b.row} * corners();
      return std::lexicographical_compare(v + 4, v + corners(), w + 4, w + corners());
    };
    std::uint32_t* to = out_.cells.data() + std::size_t{begin} * corners();
    const auto write = [&](const Row& r, std::uint32_t rank) {
      std::copy_n(cells + std::size_t{r.row} * corners(), corners(),
                  to + std::size_t{rank} * corners());
      rank_[cells_[begin + r.row]] = begin + rank;
    };
    std::uint32_t at = 0;
    for (const std::uint32_t end : ends) {
      Row* const r = rows.data() + at;
      const std::uint32_t n = end - at;
      if (n > 1) std::sort(r, r + n, less);
      for (std::uint32_t i = 0; i < n; ++i) write(r[i], at + i);
      at = end;
    }
  }

  void write_neighbours() {
    run_.each(store_.count(), light_grain, [&](std::uint64_t begin, std::uint64_t end) {
      for (std::uint64_t i = begin; i < end; ++i) {
        const auto c = static_cast<std::uint32_t>(i);
        if (rank_[c] == no_index) continue;
        const std::uint32_t* n = store_.neighbours(c);
        std::uint32_t* to = out_.neighbours.data() + std::size_t{rank_[c]} * corners();
        for (unsigned j = 0; j < corners(); ++j) to[j] = rank_[store_.cell_of(n[j])];
      }
    });
  }

  const LiftedPoints& s_;
  CellStore<K>& store_;
  Triangulation& out_;
  const Run& run_;
  unsigned shift_;  ///< a bucket has 2^shift_ ids
  std::uint64_t buckets_, chunk_ = 0;
  std::vector<std::uint32_t> begins_;         ///< by chunk: where its part of each bucket begins
  std::vector<std::uint32_t> bucket_begins_;  ///< of each bucket; at the end the number of cells
  Array<std::uint32_t> cells_;                ///< cells of the store, by place in the buckets
  Array<std::uint32_t>
      rank_;  ///< number of each cell of the store; no_index except for finite ones
};

}  // namespace

void write_boundary(const Triangulation& t, const std::uint8_t* kept,
                    Array<std::uint32_t>& boundary, Array<std::uint32_t>& boundary_cells,
                    const Run& run) {
  boundary.clear();
  boundary_cells.clear();
  if (t.corners() < 2) return;
  const unsigned k = t.corners() - 1;
  const std::vector<OpenFacet> facets = open_facets(t, kept, run);
  Array<std::uint32_t> ids(facets.size() * k);
  const auto row = [&](std::uint64_t f) { return ids.data() + f * k; };
  run.each(facets.size(), light_grain, [&](std::uint64_t begin, std::uint64_t end) {
    for (std::uint64_t f = begin; f < end; ++f)
      outward_facet(t.cell(facets[f].cell), facets[f].slot, row(f));
  });
  Adjacency<std::uint32_t, std::uint32_t> order(t.point_count, [&](const auto& add) {
    for (std::uint32_t f = 0; f < facets.size(); ++f) add(row(f)[0], f);
  });
  run.each(t.point_count, light_grain, [&](std::uint64_t begin, std::uint64_t end) {
    for (std::uint64_t v = begin; v < end; ++v) {
      const std::span<std::uint32_t> own = order.list(v);
      if (own.size() > 1)
        std::sort(own.begin(), own.end(), [&](std::uint32_t f, std::uint32_t g) {
          return std::lexicographical_compare(row(f), row(f) + k, row(g), row(g) + k);
        });
    }
  });
  boundary.reserve(ids.size());
  boundary_cells.reserve(facets.size());
  for (const std::uint32_t f : order.items()) {
    boundary.insert(boundary.end(), row(f), row(f) + k);
    boundary_cells.push_back(facets[f].cell);
  }
}

void keep_cells(Triangulation& t, const std::uint8_t* kept) {
  std::vector<std::uint32_t> number(t.size(), no_index);
  std::uint32_t count = 0;
  for (std::uint32_t c = 0; c < t.size(); ++c)
    if (kept[c] != 0) number[c] = count++;
  Array<std::uint32_t> cells, neighbours;
  for (std::uint32_t c = 0; c < number.size(); ++c) {
    if (number[c] == no_index) continue;
    cells.insert(cells.end(), t.cell(c).begin(), t.cell(c).end());
    for (const std::uint32_t o : t.neighbours_of(c))
      neighbours.push_back(o == no_index ? no_index : number[o]);
  }
  t.cells = std::move(cells);
  t.neighbours = std::move(neighbours);
  t.cell_groups.clear();
  t.hidden = hidden_points(t);
}

std::vector<std::uint32_t> hidden_points(const Triangulation& t) {
  std::vector<bool> accounted_for(t.point_count);
  for (const std::uint32_t v : t.cells) accounted_for[v] = true;
  for (const DuplicatePoint& p : t.duplicates) accounted_for[p.id] = true;
  std::vector<std::uint32_t> hidden;
  for (std::uint32_t i = 0; i < t.point_count; ++i)
    if (!accounted_for[i]) hidden.push_back(i);
  return hidden;
}

std::vector<std::uint32_t> places_of_ids(const LiftedPoints& s, std::uint64_t point_count) {
  std::vector<std::uint32_t> places(point_count);
  for (std::uint32_t i = 0; i < s.count; ++i) places[s.ids[i]] = i;
  return places;
}

namespace {

// Example: a grid of 3 x 3 points has four squares, each of one circle and cut in two by its
// diagonal. The two triangles of a square are joined: their far corners are exactly on the circle.
// Across a side the far corner is outside of it: not joined. Groups are what is independent of how
// ties were broken: the Delaunay polygons themselves.

/// Joins adjacent cells of one sphere. Computes the planes of lift_block cells at a time and tests
/// by lift_side() what they leave in doubt.
template <unsigned K>
class SphereJoiner {
 public:
  SphereJoiner(const LiftedPoints& s, CellStore<K>& store, DisjointSets& sets)
      : s_(s),
        store_(store),
        sets_(sets),
        corners_(s.base + 1),
        by_planes_(s.filtered && s.stride == s.base),
        exact_bound_(exact_plane_bound(K, s.exact_limit)) {}

  /// Tests the sphere of a finite cell against its neighbours of higher numbers; perhaps not before
  /// finish().
  void add(std::uint32_t c) {
    if constexpr (K >= 2) {
      if (by_planes_) {
        const std::uint32_t* v = store_.vertices(c);
        const double* o = s_.row(v[0]);
        for (unsigned i = 0; i < K; ++i)
          for (unsigned j = 0; j < K; ++j)
            rows_[(i * (K + 1) + j) * lift_block + open_] = s_.row(v[i + 1])[j] - o[j];
        for (std::size_t j = 0; j < corners_.size(); ++j) {
          const std::uint32_t neighbour = store_.cell_of(store_.neighbours(c)[j]);
          prefetch_line(store_.vertices(neighbour));
          sets_.prefetch(neighbour);
        }
        cells_[open_] = c;
        if (++open_ == lift_block) finish();
        return;
      }
    }
    test(c, [](const double*) { return Doubt::any; });
  }
  void finish() {
    if constexpr (K >= 2) {
      if (open_ == 0) return;
      double planes[(K + 3) * lift_block], normal[K + 3];
      lift_planes(K, rows_, nullptr, planes);
      for (std::size_t i = 0; i < open_; ++i) {
        for (unsigned j = 0; j < K + 3; ++j) normal[j] = planes[j * lift_block + i];
        const double* o = s_.row(store_.vertices(cells_[i])[0]);
        test(cells_[i], [&](const double* q) {
          const auto [value, bound] =
              plane_side<K>(normal, normal[K + 1], normal[K + 2], o, q, s_.tiny);
          if (bound <= exact_bound_) return value == 0 ? Doubt::on : Doubt::off;
          return std::abs(value) > bound ? Doubt::off : Doubt::any;
        });
      }
      open_ = 0;
    }
  }

 private:
  enum class Doubt : std::uint8_t { on, off, any };

  template <class Known>
  void test(std::uint32_t c, const Known& known) {
    const std::uint32_t *v = store_.vertices(c), *across = store_.neighbours(c);
    for (std::size_t j = 0; j < corners_.size(); ++j) {
      const std::uint32_t o = store_.cell_of(across[j]);
      const std::uint32_t q = store_.vertices(o)[store_.slot_of(across[j])];
      if (o < c || q == infinite) continue;
      const Doubt side = known(s_.row(q));
      if (side == Doubt::on || (side == Doubt::any && on_sphere(v, q))) sets_.join(c, o);
    }
  }
  bool on_sphere(const std::uint32_t* v, std::uint32_t q) {
    if constexpr (K >= 2) {
      Sign side = Sign::zero;
      if (!s_.powers.empty() && lift_side_by_powers<K>(s_, v, q, side)) return false;
    }
    for (std::size_t i = 0; i < corners_.size(); ++i) corners_[i] = s_.row(v[i]);
    constexpr unsigned k = K == 1 ? 0 : K;  // lift_side() has no filter for a line
    return lift_side<k>(s_, corners_.data(), s_.row(q), counts_) == Sign::zero;
  }

  const LiftedPoints& s_;
  CellStore<K>& store_;
  DisjointSets& sets_;
  std::vector<const double*> corners_;
  bool by_planes_;
  double exact_bound_;
  LiftCounts counts_;
  std::size_t open_ = 0;
  std::uint32_t cells_[lift_block] = {};
  double rows_[(K + 1) * (K + 1) * lift_block] = {};
};

}  // namespace

template <unsigned K>
DisjointSets cells_of_spheres(const LiftedPoints& s, CellStore<K>& store, const Run& run) {
  DisjointSets sets(store.count());
  sets.clear(0, store.count());
  run.each(store.count(), light_grain / 16, [&](std::uint64_t begin, std::uint64_t end) {
    SphereJoiner<K> joiner(s, store, sets);
    for (auto c = static_cast<std::uint32_t>(begin); c < end; ++c)
      if (!store.dead(c) && store.ghost_slot(c) == store.corners()) joiner.add(c);
    joiner.finish();
  });
  return sets;
}
template DisjointSets cells_of_spheres(const LiftedPoints&, CellStore<2>&, const Run&);

void write_groups(DisjointSets& sets, std::span<std::uint32_t> rank, Triangulation& out,
                  const Run& run) {
  Array<std::uint32_t> groups(out.size());
  run.each(rank.size(), light_grain, [&](std::uint64_t begin, std::uint64_t end) {
    for (auto c = static_cast<std::uint32_t>(begin); c < end; ++c)
      if (rank[c] != no_index) groups[rank[c]] = sets.root(c);
  });
  const std::span<std::uint32_t> number = rank;  // of each root's group
  std::fill(number.begin(), number.end(), no_index);
  std::uint32_t next = 0;
  for (std::uint32_t& group : groups) {
    std::uint32_t& known = number[group];
    if (known == no_index) known = next++;
    group = known;
  }
  if (next < groups.size()) out.cell_groups = std::move(groups);
}

template <unsigned K>
void write_cells(const LiftedPoints& s, CellStore<K>& store, Triangulation& out, const Run& run) {
  std::optional<DisjointSets> spheres;
  if (out.statistics.ties > 0) spheres = cells_of_spheres(s, store, run);
  Array<std::uint32_t> rank = CellWriter<K>(s, store, out, run).write();
  if (spheres) write_groups(*spheres, rank, out, run);
  write_boundary(out, nullptr, out.hull_facets, out.hull_cells, run);
}
template void write_cells(const LiftedPoints&, CellStore<0>&, Triangulation&, const Run&);
template void write_cells(const LiftedPoints&, CellStore<1>&, Triangulation&, const Run&);
template void write_cells(const LiftedPoints&, CellStore<2>&, Triangulation&, const Run&);
template void write_cells(const LiftedPoints&, CellStore<3>&, Triangulation&, const Run&);
template void write_cells(const LiftedPoints&, CellStore<4>&, Triangulation&, const Run&);
template void write_cells(const LiftedPoints&, CellStore<5>&, Triangulation&, const Run&);
template void write_cells(const LiftedPoints&, CellStore<6>&, Triangulation&, const Run&);

}  // namespace cullhull::internal
