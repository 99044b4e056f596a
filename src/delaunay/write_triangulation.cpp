#include "delaunay/write_triangulation.hpp"

#include <algorithm>
#include <bit>
#include <numeric>
#include <utility>

#include "exact/insphere/lift_side.hpp"
#include "parallel/disjoint_sets.hpp"
#include "parallel/dispatch.hpp"
#include "parallel/prefetch.hpp"
#include "parallel/radix_sort.hpp"
#include "parallel/sort_few.hpp"

namespace cullhull::internal::inline delaunay {
namespace {

/// Sorts a row of ids ascending and carries its neighbours along; whether the permutation is odd.
bool sort_corners(std::uint32_t* v, std::uint32_t* n, unsigned count) {
  bool odd = false;
  for (unsigned i = 1; i < count; ++i)
    for (unsigned j = i; j > 0 && v[j] < v[j - 1]; --j) {
      std::swap(v[j], v[j - 1]);
      if (n != nullptr) std::swap(n[j], n[j - 1]);
      odd = !odd;
    }
  return odd;
}

/// Corners as Triangulation has them: an odd permutation is made even by the last two.
template <unsigned K>
void order_corners(std::uint32_t* v, std::uint32_t* n, unsigned count) {
  if constexpr (K == 0) {
    if (!sort_corners(v, n, count)) return;
    std::swap(v[count - 1], v[count - 2]);
    std::swap(n[count - 1], n[count - 2]);
  } else {
    std::uint64_t both[K + 1];
    for (unsigned i = 0; i <= K; ++i) both[i] = std::uint64_t{v[i]} << 32 | n[i];
    if (sort_few<K + 1>(both)) std::swap(both[K], both[K - 1]);
    for (unsigned i = 0; i <= K; ++i) {
      v[i] = static_cast<std::uint32_t>(both[i] >> 32);
      n[i] = static_cast<std::uint32_t>(both[i]);
    }
  }
}

/// A row of ids, as far as it decides most comparisons.
struct Ranked {
  std::uint32_t ids[3], row;
};

Ranked ranked(const std::uint32_t* ids, unsigned width, std::uint32_t row) {
  return {{ids[0], width > 1 ? ids[1] : 0, width > 2 ? ids[2] : 0}, row};
}

/// Sorts rows of `width` ids, all different, lexicographically; `ids_of(row)` are all of its ids.
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
  // Each run of equal first ids belongs to the chunk it begins in. Where chunks end is settled
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

/// Facets without a neighbour: those of each chunk of cells, in order.
struct OpenFacet {
  std::uint32_t cell, slot;
};
std::vector<OpenFacet> open_facets(const Triangulation& out, const Run& run) {
  const std::uint64_t corners = out.corners(), chunk = light_grain;
  std::vector<std::vector<OpenFacet>> found(chunk_count(out.size(), chunk));
  run.each_chunk(out.size(), chunk, [&](std::uint64_t c, std::uint64_t begin, std::uint64_t end) {
    for (std::uint64_t i = begin * corners; i < end * corners; ++i)
      if (out.neighbours[i] == no_cell)
        found[c].push_back(
            {static_cast<std::uint32_t>(i / corners), static_cast<std::uint32_t>(i % corners)});
  });
  std::vector<OpenFacet> all;
  for (const auto& list : found) all.insert(all.end(), list.begin(), list.end());
  return all;
}

void write_hull(Triangulation& out, const Run& run) {
  const unsigned k = out.corners() - 1;
  const std::vector<OpenFacet> facets = open_facets(out, run);
  Array<std::uint32_t> ids(facets.size() * k);
  Array<Ranked> order(facets.size());
  run.each(facets.size(), light_grain, [&](std::uint64_t begin, std::uint64_t end) {
    for (std::uint64_t f = begin; f < end; ++f) {
      const unsigned slot = facets[f].slot;
      const auto cell = out.cell(facets[f].cell);
      std::uint32_t* row = ids.data() + f * k;
      for (unsigned i = 0, to = 0; i <= k; ++i)
        if (i != slot) row[to++] = cell[i];
      // The boundary of a positive cell without corner j has the sign (-1)^j.
      const bool odd = sort_corners(row, nullptr, k) != (slot % 2 == 1);
      if (odd && k > 1) std::swap(row[k - 1], row[k - 2]);
      order[f] = ranked(row, k, static_cast<std::uint32_t>(f));
    }
  });
  sort_rows(order, k, static_cast<std::uint32_t>(out.point_count), run,
            [&](std::uint32_t f) { return ids.data() + std::size_t{f} * k; });
  out.hull_facets.resize(ids.size());
  out.hull_cells.resize(facets.size());
  for (std::size_t f = 0; f < facets.size(); ++f) {
    std::copy_n(ids.data() + std::size_t{order[f].row} * k, k, out.hull_facets.data() + f * k);
    out.hull_cells[f] = facets[order[f].row].cell;
  }
}

/// Finite cells with the caller's ids, corners in order, as rows to be sorted; `rank` of others.
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
      order_corners<K>(v, store.neighbours(c), corners);
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
        const auto back = t.neighbours_of(o);
        const auto slot = std::find(back.begin(), back.end(), c) - back.begin();
        const std::uint32_t q = t.cell(o)[static_cast<std::size_t>(slot)];
        if (lift_side<K>(s, rows.data(), s.row(places[q]), counts) == Sign::zero)
          sets.join(static_cast<std::uint32_t>(c), o);
      }
    }
  });
}

}  // namespace

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
  write_hull(out, run);
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
