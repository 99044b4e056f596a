#include "lifting/write_triangulation.hpp"

#include <algorithm>
#include <bit>
#include <numeric>
#include <utility>

#include "lifting/lift_side.hpp"
#include "parallel/disjoint_sets.hpp"
#include "parallel/dispatch.hpp"
#include "parallel/radix_sort.hpp"

namespace cullhull::internal {
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
void order_corners(std::uint32_t* v, std::uint32_t* n, unsigned count) {
  if (!sort_corners(v, n, count)) return;
  std::swap(v[count - 1], v[count - 2]);
  if (n != nullptr) std::swap(n[count - 1], n[count - 2]);
}

struct Ranked {
  std::uint32_t first, cell;
};

/// The order of rows of `width` ids, lexicographic, all different.
Array<Ranked> sorted_rows(const std::uint32_t* rows, std::uint32_t count, unsigned width,
                          std::uint32_t id_limit, const Run& run) {
  Array<Ranked> order(count), scratch(count);
  run.each(count, light_grain, [&](std::uint64_t begin, std::uint64_t end) {
    for (std::uint64_t i = begin; i < end; ++i)
      order[i] = {rows[i * width], static_cast<std::uint32_t>(i)};
  });
  Ranked *items = order.data(), *other = scratch.data();
  radix_sort(items, other, count, static_cast<unsigned>(std::bit_width(id_limit)), run,
             [](const Ranked& r) { return r.first; });
  if (items != order.data()) std::swap(order, scratch);
  const auto less = [&](const Ranked& a, const Ranked& b) {
    const std::uint32_t* p = rows + std::size_t{a.cell} * width;
    const std::uint32_t* q = rows + std::size_t{b.cell} * width;
    return std::lexicographical_compare(p, p + width, q, q + width);
  };
  // Each run of equal first ids belongs to the chunk it begins in.
  run.each(count, light_grain, [&](std::uint64_t begin, std::uint64_t end) {
    std::uint64_t i = begin;
    while (i > 0 && i < end && order[i].first == order[i - 1].first) ++i;
    while (i < end) {
      std::uint64_t next = i + 1;
      while (next < count && order[next].first == order[i].first) ++next;
      std::sort(order.begin() + static_cast<std::ptrdiff_t>(i),
                order.begin() + static_cast<std::ptrdiff_t>(next), less);
      i = next;
    }
  });
  return order;
}

void write_hull(Triangulation& out, const Run& run) {
  const unsigned k = out.corners() - 1;
  const std::uint64_t cells = out.size();
  std::uint32_t hull = 0, most = 0;
  for (const std::uint32_t n : out.neighbours) hull += n == no_cell ? 1 : 0;
  Array<std::uint32_t> rows(std::size_t{hull} * k), owner(hull);
  std::uint32_t at = 0;
  for (std::uint64_t c = 0; c < cells; ++c)
    for (unsigned j = 0; j <= k; ++j) {
      if (out.neighbours[c * (k + 1) + j] != no_cell) continue;
      std::uint32_t* row = rows.data() + std::size_t{at} * k;
      for (unsigned i = 0, to = 0; i <= k; ++i)
        if (i != j) row[to++] = out.cells[c * (k + 1) + i];
      // The boundary of a positive cell without corner j has the sign (-1)^j.
      if (sort_corners(row, nullptr, k) != (j % 2 == 1) && k > 1) std::swap(row[k - 1], row[k - 2]);
      most = std::max(most, row[0]);
      owner[at++] = static_cast<std::uint32_t>(c);
    }
  const Array<Ranked> order = sorted_rows(rows.data(), hull, k, most, run);
  out.hull_facets.resize(rows.size());
  out.hull_cells.resize(hull);
  for (std::uint32_t f = 0; f < hull; ++f) {
    std::copy_n(rows.data() + std::size_t{order[f].cell} * k, k,
                out.hull_facets.data() + std::size_t{f} * k);
    out.hull_cells[f] = owner[order[f].cell];
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

void write_cells(const LiftedPoints& s, RawCells&& raw, Triangulation& out, const Run& run) {
  const unsigned corners = out.corners();
  const auto cells = static_cast<std::uint32_t>(raw.vertices.size() / corners);
  run.each(cells, light_grain, [&](std::uint64_t begin, std::uint64_t end) {
    for (std::uint64_t c = begin; c < end; ++c) {
      std::uint32_t* v = raw.vertices.data() + c * corners;
      for (unsigned i = 0; i < corners; ++i) v[i] = s.ids[v[i]];
      order_corners(v, raw.neighbours.data() + c * corners, corners);
    }
  });
  const Array<Ranked> order = sorted_rows(raw.vertices.data(), cells, corners,
                                          static_cast<std::uint32_t>(out.point_count), run);
  Array<std::uint32_t> rank(cells);
  run.each(cells, light_grain, [&](std::uint64_t begin, std::uint64_t end) {
    for (std::uint64_t i = begin; i < end; ++i) rank[order[i].cell] = static_cast<std::uint32_t>(i);
  });
  out.cells.resize(raw.vertices.size());
  out.neighbours.resize(raw.vertices.size());
  run.each(cells, light_grain, [&](std::uint64_t begin, std::uint64_t end) {
    for (std::uint64_t i = begin; i < end; ++i) {
      const std::size_t from = std::size_t{order[i].cell} * corners;
      std::copy_n(raw.vertices.data() + from, corners, out.cells.data() + i * corners);
      for (unsigned j = 0; j < corners; ++j) {
        const std::uint32_t o = raw.neighbours[from + j];
        out.neighbours[i * corners + j] = o == no_cell ? no_cell : rank[o];
      }
    }
  });
  write_hull(out, run);
}

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

}  // namespace cullhull::internal
