#include "delaunay/write_triangulation.hpp"

#include <algorithm>
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

/// Replaces the vertices of finite cells by the caller's ids and orders their corners; returns
/// these cells as rows to be sorted. Sets `rank` of all other cells to no_cell.
template <unsigned K>
Array<Ranked> finite_cells(const LiftedPoints& s, CellStore<K>& store, Array<std::uint32_t>& rank,
                           const Run& run) {
  const unsigned corners = store.corners();
  constexpr std::uint64_t chunk = light_grain;
  std::vector<std::uint32_t> begins(chunk_count(store.count(), chunk) + 1, 0);
  const auto finite = [&](std::uint32_t c) {
    return !store.dead(c) && store.ghost_slot(c) == corners;
  };
  run.each_chunk(store.count(), chunk,
                 [&](std::uint64_t at, std::uint64_t begin, std::uint64_t end) {
    for (std::uint64_t c = begin; c < end; ++c)
      begins[at + 1] += finite(static_cast<std::uint32_t>(c)) ? 1 : 0;
  });
  for (std::size_t i = 1; i < begins.size(); ++i) begins[i] += begins[i - 1];
  Array<Ranked> rows(begins.back());
  run.each_chunk(store.count(), chunk,
                 [&](std::uint64_t at, std::uint64_t begin, std::uint64_t end) {
    std::uint32_t to = begins[at];
    for (std::uint64_t i = begin; i < end; ++i) {
      const auto c = static_cast<std::uint32_t>(i);
      if (!finite(c)) {
        rank[c] = no_cell;
        continue;
      }
      std::uint32_t* v = store.vertices(c);
      for (unsigned j = 0; j < corners; ++j) v[j] = s.ids[v[j]];
      sort_simplex<K == 0 ? 0 : K + 1, true>(v, store.neighbours(c), corners);
      rows[to++] = ranked(v, corners, c);
    }
  });
  return rows;
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
  Array<std::uint32_t> rank(store.count());
  Array<Ranked> order = finite_cells(s, store, rank, run);
  sort_rows(order, corners, static_cast<std::uint32_t>(out.point_count), run,
            [&](std::uint32_t c) { return store.vertices(c); });
  run.each(order.size(), light_grain, [&](std::uint64_t begin, std::uint64_t end) {
    for (std::uint64_t i = begin; i < end; ++i) rank[order[i].row] = static_cast<std::uint32_t>(i);
  });
  out.cells.resize(order.size() * corners);
  out.neighbours.resize(order.size() * corners);
  run.each(order.size(), light_grain, [&](std::uint64_t begin, std::uint64_t end) {
    constexpr std::uint64_t far = 24, near = 12;
    for (std::uint64_t i = begin; i < end; ++i) {
      if (i + far < end) prefetch_line(store.vertices(order[i + far].row));
      if (i + near < end) {
        const std::uint32_t* n = store.neighbours(order[i + near].row);
        for (unsigned j = 0; j < corners; ++j) prefetch_line(&rank[store.cell_of(n[j])]);
      }
      const std::uint32_t *v = store.vertices(order[i].row), *n = store.neighbours(order[i].row);
      for (unsigned j = 0; j < corners; ++j) {
        out.cells[i * corners + j] = v[j];
        out.neighbours[i * corners + j] = rank[store.cell_of(n[j])];
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
