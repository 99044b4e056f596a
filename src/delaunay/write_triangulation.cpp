#include "delaunay/write_triangulation.hpp"

#include <algorithm>
#include <atomic>
#include <bit>
#include <numeric>
#include <utility>

#include "exact/insphere/lift_side.hpp"
#include "geometry/simplex.hpp"
#include "parallel/disjoint_sets.hpp"
#include "parallel/dispatch.hpp"
#include "parallel/index.hpp"
#include "parallel/prefetch.hpp"
#include "parallel/radix_sort.hpp"

namespace cullhull::internal::inline delaunay {
namespace {

/// A row of ids for sorting: its first ids, which decide most comparisons, and its number.
struct Ranked {
  std::uint32_t ids[3], row;
};

Ranked ranked(const std::uint32_t* ids, unsigned width, std::uint32_t row) {
  return {{ids[0], width > 1 ? ids[1] : 0, width > 2 ? ids[2] : 0}, row};
}

/// Sorts distinct rows of `width` ids lexicographically. ids_of(row): all ids of a row.
template <class IdsOf>
void sort_rows(Array<Ranked>& rows, unsigned width, std::uint32_t id_limit, const Run& run,
               const IdsOf& ids_of) {
  const std::uint64_t count = rows.size();
  Array<Ranked> scratch(count);
  Ranked *items = rows.data(), *other = scratch.data();
  radix_sort(items, other, static_cast<std::uint32_t>(count),
             static_cast<unsigned>(std::bit_width(id_limit)), run,
             [](const Ranked& r) { return r.ids[0]; });
  if (items != rows.data()) std::swap(rows, scratch);
  const auto less = [&](const Ranked& a, const Ranked& b) {
    const std::uint64_t x = std::uint64_t{a.ids[1]} << 32 | a.ids[2],
                        y = std::uint64_t{b.ids[1]} << 32 | b.ids[2];
    if (x != y) return x < y;
    if (width <= 3) return false;
    const std::uint32_t *p = ids_of(a.row), *q = ids_of(b.row);
    return std::lexicographical_compare(p, p + width, q, q + width);
  };
  // Each run of equal first ids belongs to the chunk it begins in. The ends of the chunks are found
  // before any of them is sorted.
  constexpr std::uint64_t chunk = light_grain;
  std::vector<std::uint64_t> begins(chunk_count(count, chunk) + 1, count);
  for (std::size_t c = 0; c + 1 < begins.size(); ++c) {
    std::uint64_t i = c * chunk;
    while (i > 0 && i < count && rows[i].ids[0] == rows[i - 1].ids[0]) ++i;
    begins[c] = i;
  }
  run.each_chunk(count, chunk, [&](std::uint64_t c, std::uint64_t, std::uint64_t) {
    for (std::uint64_t i = begins[c]; i < begins[c + 1];) {
      std::uint64_t next = i + 1;
      while (next < begins[c + 1] && rows[next].ids[0] == rows[i].ids[0]) ++next;
      if (next - i > 1)
        std::sort(rows.begin() + static_cast<std::ptrdiff_t>(i),
                  rows.begin() + static_cast<std::ptrdiff_t>(next), less);
      i = next;
    }
  });
}

/// A facet between a kept cell and a cell that is not kept, or no cell.
struct OpenFacet {
  std::uint32_t cell, slot;
};
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
      if (o != no_cell && (kept == nullptr || kept[o] != 0)) continue;
      const auto c = static_cast<std::uint32_t>(i / corners);
      if (kept == nullptr || kept[c] != 0)
        found[at].push_back({c, static_cast<std::uint32_t>(i % corners)});
    }
  });
  std::vector<OpenFacet> all;
  for (const auto& list : found) all.insert(all.end(), list.begin(), list.end());
  return all;
}

/// Finite cells by their lowest vertex, and the numbers by which they are written.
struct CellOrder {
  Array<std::uint32_t> ends;   ///< for each id the end of its cells in `cells`
  Array<std::uint32_t> cells;  ///< of each id, in the order of writing once sort_cells() has run
  Array<std::uint32_t>
      rank;  ///< the number of a cell of the store; no_cell for all but finite ones

  std::uint32_t begin(std::uint64_t id) const { return id == 0 ? 0 : ends[id - 1]; }
};

/// Adds 1 to a counter that threads may share, and returns what it was.
inline std::uint32_t add_one(std::uint32_t& counter, bool shared) {
  if (!shared) return counter++;
  return std::atomic_ref(counter).fetch_add(1, std::memory_order_relaxed);
}

/// Replaces the vertices of finite cells by the caller's ids, orders their corners and lists the
/// cells by their lowest id. The order of the cells of an id depends on the threads.
template <unsigned K>
CellOrder cells_by_lowest(const LiftedPoints& s, CellStore<K>& store, std::uint64_t point_count,
                          const Run& run) {
  const unsigned corners = store.corners();
  const bool shared = run.threads > 1 && store.count() > light_grain;
  CellOrder order;
  order.rank.resize(store.count());
  order.ends.resize(point_count);
  run.each(point_count, light_grain, [&](std::uint64_t begin, std::uint64_t end) {
    std::fill(order.ends.data() + begin, order.ends.data() + end, 0U);
  });
  run.each(store.count(), light_grain, [&](std::uint64_t begin, std::uint64_t end) {
    for (std::uint64_t i = begin; i < end; ++i) {
      const auto c = static_cast<std::uint32_t>(i);
      if (store.dead(c) || store.ghost_slot(c) != corners) {
        order.rank[c] = no_cell;
        continue;
      }
      std::uint32_t* v = store.vertices(c);
      for (unsigned j = 0; j < corners; ++j) v[j] = s.ids[v[j]];
      sort_simplex<K == 0 ? 0 : K + 1, true>(v, store.neighbours(c), corners);
      order.rank[c] = v[0];
      add_one(order.ends[v[0]], shared);
    }
  });
  std::uint32_t all = 0;
  for (std::uint32_t& end : order.ends) all += std::exchange(end, all);
  order.cells.resize(all);
  run.each(store.count(), light_grain, [&](std::uint64_t begin, std::uint64_t end) {
    for (std::uint64_t c = begin; c < end; ++c)
      if (const std::uint32_t lowest = order.rank[c]; lowest != no_cell)
        order.cells[add_one(order.ends[lowest], shared)] = static_cast<std::uint32_t>(c);
  });
  return order;
}

/// Sorts the cells of ids [first, last) by all their corners, and numbers them.
template <unsigned K>
void sort_cells(CellStore<K>& store, CellOrder& order, std::uint64_t first, std::uint64_t last) {
  const unsigned corners = store.corners();
  const auto less = [&](std::uint32_t a, std::uint32_t b) {
    const std::uint32_t *v = store.vertices(a), *w = store.vertices(b);
    for (unsigned j = 1; j < corners; ++j)
      if (v[j] != w[j]) return v[j] < w[j];
    return false;
  };
  constexpr std::uint32_t ahead = 16;  // cells: about the delay of memory
  constexpr std::uint32_t few = 24;    // sorted by insertion; an id has 2 in the plane, 7 in space
  const std::uint32_t stop = order.begin(last);
  std::uint32_t* const cells = order.cells.data();
  for (std::uint64_t id = first; id < last; ++id) {
    const std::uint32_t begin = order.begin(id), end = order.ends[id];
    for (std::uint32_t i = begin; i < end; ++i)
      if (i + ahead < stop) prefetch_line(store.vertices(cells[i + ahead]));
    if (end - begin > few) {
      std::sort(cells + begin, cells + end, less);
    } else {
      for (std::uint32_t i = begin + 1; i < end; ++i) {
        const std::uint32_t c = cells[i];
        std::uint32_t to = i;
        for (; to > begin && less(c, cells[to - 1]); --to) cells[to] = cells[to - 1];
        cells[to] = c;
      }
    }
    for (std::uint32_t i = begin; i < end; ++i) order.rank[cells[i]] = i;
  }
}

template <unsigned K>
void join_groups(const LiftedPoints& s, const std::vector<std::uint32_t>& places,
                 const Triangulation& t, DisjointSets& sets, const Run& run) {
  const unsigned corners = t.corners();
  run.each(t.size(), light_grain / 16, [&](std::uint64_t begin, std::uint64_t end) {
    LiftCounts counts;
    std::vector<const double*> rows(corners);
    for (std::uint64_t c = begin; c < end; ++c) {
      const auto cell = t.cell(c), across = t.neighbours_of(c);
      for (unsigned i = 0; i < corners; ++i) rows[i] = s.row(places[cell[i]]);
      for (unsigned j = 0; j < corners; ++j) {
        const std::uint32_t o = across[j];
        if (o == no_cell || o < c) continue;
        const std::uint32_t q = t.cell(o)[place_in(t.neighbours_of(o), c)];
        if (lift_side<K>(s, rows.data(), s.row(places[q]), counts) == Sign::zero)
          sets.join(static_cast<std::uint32_t>(c), o);
      }
    }
  });
}

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
  Array<Ranked> order(facets.size());
  run.each(facets.size(), light_grain, [&](std::uint64_t begin, std::uint64_t end) {
    for (std::uint64_t f = begin; f < end; ++f) {
      std::uint32_t* row = ids.data() + f * k;
      outward_facet(t.cell(facets[f].cell), facets[f].slot, row);
      order[f] = ranked(row, k, static_cast<std::uint32_t>(f));
    }
  });
  sort_rows(order, k, static_cast<std::uint32_t>(t.point_count), run,
            [&](std::uint32_t f) { return ids.data() + std::size_t{f} * k; });
  boundary.resize(ids.size());
  boundary_cells.resize(facets.size());
  for (std::size_t f = 0; f < facets.size(); ++f) {
    std::copy_n(ids.data() + std::size_t{order[f].row} * k, k, boundary.data() + f * k);
    boundary_cells[f] = facets[order[f].row].cell;
  }
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

template <unsigned K>
void write_cells(const LiftedPoints& s, CellStore<K>& store, Triangulation& out, const Run& run) {
  const unsigned corners = store.corners();
  CellOrder order = cells_by_lowest(s, store, out.point_count, run);
  run.each(out.point_count, light_grain / 4,
           [&](std::uint64_t begin, std::uint64_t end) { sort_cells(store, order, begin, end); });
  const std::uint64_t count = order.cells.size();
  out.cells.resize(count * corners);
  out.neighbours.resize(count * corners);
  run.each(count, light_grain, [&](std::uint64_t begin, std::uint64_t end) {
    constexpr std::uint64_t far = 24, near = 12;
    for (std::uint64_t i = begin; i < end; ++i) {
      if (i + far < end) prefetch_line(store.vertices(order.cells[i + far]));
      if (i + near < end) {
        const std::uint32_t* n = store.neighbours(order.cells[i + near]);
        for (unsigned j = 0; j < corners; ++j) prefetch_line(&order.rank[store.cell_of(n[j])]);
      }
      const std::uint32_t c = order.cells[i];
      const std::uint32_t *v = store.vertices(c), *n = store.neighbours(c);
      for (unsigned j = 0; j < corners; ++j) {
        out.cells[i * corners + j] = v[j];
        out.neighbours[i * corners + j] = order.rank[store.cell_of(n[j])];
      }
    }
  });
  write_boundary(out, nullptr, out.hull_facets, out.hull_cells, run);
}
template void write_cells(const LiftedPoints&, CellStore<0>&, Triangulation&, const Run&);
template void write_cells(const LiftedPoints&, CellStore<1>&, Triangulation&, const Run&);
template void write_cells(const LiftedPoints&, CellStore<2>&, Triangulation&, const Run&);
template void write_cells(const LiftedPoints&, CellStore<3>&, Triangulation&, const Run&);
template void write_cells(const LiftedPoints&, CellStore<4>&, Triangulation&, const Run&);
template void write_cells(const LiftedPoints&, CellStore<5>&, Triangulation&, const Run&);
template void write_cells(const LiftedPoints&, CellStore<6>&, Triangulation&, const Run&);

void write_groups(const LiftedPoints& s, Triangulation& out, const Run& run) {
  const std::uint64_t cells = out.size();
  const std::vector<std::uint32_t> places = places_of_ids(s, out.point_count);
  DisjointSets sets(cells);
  sets.clear(0, cells);
  with_dimension<2, 6, 0>(s.base, [&](auto k) { join_groups<k()>(s, places, out, sets, run); });
  Array<std::uint32_t> groups(cells);
  std::uint32_t next = 0;
  for (std::uint32_t c = 0; c < cells; ++c) {
    const std::uint32_t root = sets.root(c);
    groups[c] = root == c ? next++ : groups[root];
  }
  if (next < cells) out.cell_groups = std::move(groups);
}

}  // namespace cullhull::internal::inline delaunay
