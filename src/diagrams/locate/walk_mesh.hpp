// A triangulation stored for walks: vertices along a curve, cells near their vertices.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "cullhull/array.hpp"
#include "cullhull/triangulation.hpp"
#include "diagrams/dual.hpp"
#include "geometry/curve_frame.hpp"
#include "geometry/gather.hpp"
#include "parallel/adjacency.hpp"
#include "parallel/radix_sort.hpp"
#include "parallel/threads/run.hpp"

namespace cullhull::internal {

/// The numbers [0, keys.size()) with their keys, sorted by key; stable.
inline Array<KeyedId> sorted_by_key(const Array<std::uint32_t>& keys, unsigned bits,
                                    const Run& run) {
  const auto n = static_cast<std::uint32_t>(keys.size());
  Array<KeyedId> items(n), scratch(n);
  for (std::uint32_t i = 0; i < n; ++i) items[i] = {keys[i], i};
  KeyedId *from = items.data(), *to = scratch.data();
  radix_sort(from, to, n, bits, run);
  if (from != items.data()) std::swap(items, scratch);
  return items;
}

/// The distinct ids of all cells, ascending.
inline Array<std::uint32_t> vertices_of(const Triangulation& t) {
  std::vector<bool> seen(t.point_count);
  for (const std::uint32_t v : t.cells) seen[v] = true;
  Array<std::uint32_t> ids;
  for (std::uint64_t i = 0; i < seen.size(); ++i)
    if (seen[i]) ids.push_back(static_cast<std::uint32_t>(i));
  return ids;
}

struct WalkMesh {
  WalkMesh(const PointView& points, const Triangulation& t, std::span<const double> weights,
           const Run& run)
      : dimension(t.dimension),
        affine_dimension(t.affine_dimension),
        corners(t.cells.empty() ? 0 : t.corners()),
        stride(t.dimension + (weights.empty() ? 0 : 1)),
        furthest(t.furthest_site) {
    require_points_of(t, points, weights, run);
    columns = flat_columns(t.axes, dimension);
    if (corners > 0) take_vertices(points, t, weights, run);
  }

  unsigned dimension = 0;     ///< d
  int affine_dimension = -1;  ///< k
  unsigned corners = 0;       ///< k + 1; 0 without cells
  unsigned stride = 0;        ///< numbers per row: d, with weights d + 1
  bool furthest = false;
  std::vector<std::uint32_t> columns;  ///< flat_columns()

  /// Vertices along the curve, as rows: coordinates in the order of `columns`, then the weight.
  Array<double> rows;
  Array<std::uint32_t> ids;   ///< the caller's id of each row
  Array<std::uint32_t> keys;  ///< the curve key of each row, ascending
  CurveFrame frame;

  /// For each cell k + 1 rows, then k + 1 neighbours as places in this list.
  Array<std::uint32_t> cells;
  Array<std::uint32_t> numbers;      ///< the caller's number of the cell at each place
  Array<std::uint32_t> places;       ///< place of each of the caller's cells
  Array<std::uint32_t> lowest_cell;  ///< for each row, the place of its cell of lowest number

  std::uint32_t vertex_count() const { return static_cast<std::uint32_t>(ids.size()); }
  const double* row(std::uint32_t v) const { return rows.data() + std::size_t{v} * stride; }
  const std::uint32_t* corners_of(std::uint32_t c) const {
    return cells.data() + std::size_t{c} * 2 * corners;
  }
  const std::uint32_t* neighbours_of(std::uint32_t c) const { return corners_of(c) + corners; }
  /// The row whose key is nearest to `key`; the search starts at row `from`.
  std::uint32_t row_at(std::uint32_t key, std::uint32_t from = 0) const {
    const std::uint32_t n = vertex_count();
    std::uint32_t width = 1, high = from;
    while (high < n && keys[high] < key) {  // gallop, as the next key of a batch is near
      from = high + 1;
      high = n - high > width ? high + width : n;
      width *= 2;
    }
    const auto at = std::lower_bound(keys.begin() + from, keys.begin() + high, key) - keys.begin();
    const auto i = static_cast<std::uint32_t>(at);
    if (i == n) return n - 1;
    return i > 0 && key - keys[i - 1] < keys[i] - key ? i - 1 : i;
  }

 private:
  void take_vertices(const PointView& points, const Triangulation& t,
                     std::span<const double> weights, const Run& run) {
    const Array<std::uint32_t> vertices = vertices_of(t);
    const auto n = static_cast<std::uint32_t>(vertices.size());
    const std::vector<std::uint64_t> wide(vertices.begin(), vertices.end());
    const Array<double> gathered = gather_points(points, wide.data(), n, run);
    rows.resize(std::size_t{n} * stride);
    Array<double> by_id(rows.size());
    run.each(n, light_grain, [&](std::uint64_t begin, std::uint64_t end) {
      for (std::uint64_t i = begin; i < end; ++i) {
        double* r = by_id.data() + i * stride;
        for (unsigned j = 0; j < dimension; ++j) r[j] = gathered[i * dimension + columns[j]];
        if (stride > dimension) r[dimension] = weights[vertices[i]];
      }
    });
    frame = CurveFrame(corners - 1);
    frame.measure(
        n, [&](std::uint64_t i) { return by_id.data() + i * stride; }, run);
    Array<std::uint32_t> unsorted(n);
    run.each(n, light_grain, [&](std::uint64_t begin, std::uint64_t end) {
      frame.keys(
          end - begin, [&](std::uint64_t i) { return by_id.data() + (begin + i) * stride; },
          [&](std::uint64_t i, std::uint32_t key) { unsorted[begin + i] = key; });
    });
    const Array<KeyedId> order = sorted_by_key(unsorted, frame.key_bits(), run);
    ids.resize(n);
    keys.resize(n);
    Array<std::uint32_t> row_of(t.point_count);
    run.each(n, light_grain, [&](std::uint64_t begin, std::uint64_t end) {
      for (std::uint64_t i = begin; i < end; ++i) {
        const std::uint32_t from = order[i].id;
        ids[i] = vertices[from];
        keys[i] = order[i].key;
        row_of[ids[i]] = static_cast<std::uint32_t>(i);
        std::copy_n(by_id.data() + std::size_t{from} * stride, stride, rows.data() + i * stride);
      }
    });
    take_cells(t, row_of, run);
  }
  void take_cells(const Triangulation& t, const Array<std::uint32_t>& row_of, const Run& run) {
    const auto count = static_cast<std::uint32_t>(t.size());
    Array<std::uint32_t> first(count);
    run.each(count, light_grain, [&](std::uint64_t begin, std::uint64_t end) {
      for (std::uint64_t c = begin; c < end; ++c) {
        first[c] = ~0U;
        for (const std::uint32_t v : t.cell(c)) first[c] = std::min(first[c], row_of[v]);
      }
    });
    unsigned bits = 0;
    while (vertex_count() >> bits != 0) ++bits;
    const Array<KeyedId> order = sorted_by_key(first, bits, run);
    numbers.resize(count);
    places.resize(count);
    run.each(count, light_grain, [&](std::uint64_t begin, std::uint64_t end) {
      for (std::uint64_t i = begin; i < end; ++i) {
        numbers[i] = order[i].id;
        places[numbers[i]] = static_cast<std::uint32_t>(i);
      }
    });
    cells.resize(std::size_t{count} * 2 * corners);
    run.each(count, light_grain, [&](std::uint64_t begin, std::uint64_t end) {
      for (std::uint64_t i = begin; i < end; ++i) {
        std::uint32_t* cell = cells.data() + i * 2 * corners;
        for (const std::uint32_t v : t.cell(numbers[i])) *cell++ = row_of[v];
        for (const std::uint32_t o : t.neighbours_of(numbers[i]))
          *cell++ = o == no_index ? no_index : places[o];
      }
    });
    lowest_cell.assign(vertex_count(), no_index);
    for (std::uint32_t c = 0; c < count; ++c)
      for (const std::uint32_t v : t.cell(c))
        if (lowest_cell[row_of[v]] == no_index) lowest_cell[row_of[v]] = places[c];
  }
};

/// The rows that share a cell with each row, ascending.
inline Adjacency<std::uint32_t> neighbour_rows(const WalkMesh& mesh, const Run& run) {
  const auto count = static_cast<std::uint32_t>(mesh.numbers.size());
  Adjacency<std::uint32_t> rows(mesh.vertex_count(), [&](const auto& add) {
    for (std::uint32_t c = 0; c < count; ++c) {
      if (c % light_grain == 0) run.check();
      const std::uint32_t* v = mesh.corners_of(c);
      for (unsigned i = 0; i < mesh.corners; ++i)
        for (unsigned j = 0; j < mesh.corners; ++j)
          if (i != j) add(v[i], v[j]);
    }
  });
  rows.sort_and_unique([&] { run.check(); });
  return rows;
}

}  // namespace cullhull::internal
