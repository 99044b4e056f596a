// The ridges of a diagram: edges of the triangulation, less those within merged cells.
#include <algorithm>
#include <utility>
#include <vector>

#include "cells/dual.hpp"
#include "geometry/orientation.hpp"

namespace cullhull::internal {
namespace {

/// The vertices of each group, ascending.
class GroupVertices {
 public:
  explicit GroupVertices(const Triangulation& t) : groups_(t.cell_groups.empty() ? 0 : groups(t)) {
    if (t.cell_groups.empty()) return;
    begin_.assign(groups_ + 1, 0);
    for (std::uint64_t c = 0; c < t.size(); ++c) ++begin_[t.group(c) + 1];
    for (std::uint32_t g = 0; g < groups_; ++g) begin_[g + 1] += begin_[g];
    cells_.resize(t.size());
    Array<std::uint64_t> at(begin_);
    for (std::uint32_t c = 0; c < t.size(); ++c) cells_[at[t.group(c)]++] = c;
  }
  /// Whether cells are merged there.
  bool merged(std::uint32_t g) const { return groups_ > 0 && begin_[g + 1] - begin_[g] > 1; }
  std::vector<std::uint32_t> of(const Triangulation& t, std::uint32_t g) const {
    std::vector<std::uint32_t> v;
    for (std::uint64_t i = begin_[g]; i < begin_[g + 1]; ++i) {
      const auto cell = t.cell(cells_[i]);
      v.insert(v.end(), cell.begin(), cell.end());
    }
    std::sort(v.begin(), v.end());
    v.erase(std::unique(v.begin(), v.end()), v.end());
    return v;
  }

 private:
  static std::uint32_t groups(const Triangulation& t) {
    return *std::max_element(t.cell_groups.begin(), t.cell_groups.end()) + 1;
  }
  std::uint32_t groups_;
  Array<std::uint64_t> begin_;
  Array<std::uint32_t> cells_;
};

/// One edge with the cells around it.
struct Edge {
  std::uint32_t low, high;
  std::span<const EdgeCells::Item> cells;
};

class RidgeWriter {
 public:
  RidgeWriter(const DualPoints& p, const Triangulation& t, const GroupVertices& groups)
      : p_(p), t_(t), groups_(groups), k_(t.corners() - 1) {}

  /// The vertices of the edge's ridge; false if it has none of dimension k - 1.
  bool write(const Edge& e, std::vector<std::uint32_t>& out) {
    out.clear();
    if (within_merged(e)) return false;
    if (k_ == 2)
      in_plane(e, out);
    else if (k_ == 3)
      in_space(e, out);
    else
      in_any(e, out);
    return true;
  }

 private:
  bool on_edge(const Edge& e, std::uint32_t v) const { return v == e.low || v == e.high; }

  /// The edge is none of the merged complex if the least face of that complex that has it has other
  /// vertices too: those common to all merged cells around it that lie in the planes of all facets
  /// of the hull at it.
  bool within_merged(const Edge& e) {
    if (k_ < 2) return false;
    bool any = false;
    for (const auto& item : e.cells) any = any || groups_.merged(t_.group(item.cell));
    if (!any) return false;
    std::vector<std::uint32_t> common = groups_.of(t_, t_.group(e.cells[0].cell)), both;
    for (const auto& item : e.cells) {
      if (common.size() == 2) return false;
      const std::vector<std::uint32_t> next = groups_.of(t_, t_.group(item.cell));
      both.clear();
      std::set_intersection(common.begin(), common.end(), next.begin(), next.end(),
                            std::back_inserter(both));
      std::swap(common, both);
    }
    for (const auto& item : e.cells) keep_on_hull(e, item.cell, common);
    return common.size() > 2;
  }

  /// Erases points off the hull's planes through the facets of the cell that have the edge.
  void keep_on_hull(const Edge& e, std::uint32_t c, std::vector<std::uint32_t>& points) {
    for (unsigned j = 0; j <= k_; ++j) {
      if (t_.neighbours_of(c)[j] != no_cell || on_edge(e, t_.cell(c)[j])) continue;
      std::erase_if(points, [&](std::uint32_t v) { return !on_plane(c, j, v); });
    }
  }
  /// Whether v is in the plane of the facet opposite to corner j of the cell.
  bool on_plane(std::uint32_t c, unsigned j, std::uint32_t v) {
    rows_.resize((k_ + 1) * k_);
    std::vector<const double*> at(k_ + 1);
    for (unsigned i = 0; i <= k_; ++i) {
      const double* from = p_.row(i == j ? v : t_.cell(c)[i]);
      double* to = rows_.data() + std::size_t{i} * k_;
      for (unsigned a = 0; a < k_; ++a) to[a] = from[t_.axes[a]];
      at[i] = to;
    }
    return orientation(k_, at.data()) == Sign::zero;
  }

  /// Left, then right. In a triangle low is followed by high where its third corner is on the left.
  void in_plane(const Edge& e, std::vector<std::uint32_t>& out) const {
    out.assign(2, at_infinity);
    for (const auto& item : e.cells) {
      const auto v = t_.cell(item.cell);
      const bool left = (v[0] == e.low && v[1] == e.high) || (v[1] == e.low && v[2] == e.high) ||
                        (v[2] == e.low && v[0] == e.high);
      out[left ? 0 : 1] = t_.group(item.cell);
    }
  }

  /// Places in the cell of the corners off the edge, so that from the first to the second is a
  /// positive turn around the way from low to high.
  std::pair<unsigned, unsigned> others(const Edge& e, std::uint32_t c) const {
    const auto v = t_.cell(c);
    unsigned order[4], n = 2;
    for (unsigned i = 0; i < 4; ++i) order[v[i] == e.low ? 0 : v[i] == e.high ? 1 : n++] = i;
    unsigned inversions = 0;
    for (unsigned i = 0; i < 4; ++i)
      for (unsigned j = i + 1; j < 4; ++j) inversions += order[i] > order[j] ? 1 : 0;
    if (inversions % 2 == 1) std::swap(order[2], order[3]);
    return {order[2], order[3]};
  }

  void in_space(const Edge& e, std::vector<std::uint32_t>& out) const {
    std::uint32_t first = e.cells[0].cell;
    for (const auto& item : e.cells) {  // infinity first
      if (t_.neighbours_of(item.cell)[others(e, item.cell).second] != no_cell) continue;
      out.push_back(at_infinity);
      first = item.cell;
    }
    for (std::uint32_t c = first;;) {
      if (out.empty() || out.back() != t_.group(c)) out.push_back(t_.group(c));
      c = t_.neighbours_of(c)[others(e, c).first];
      if (c == no_cell || c == first) break;
    }
    if (out.front() == at_infinity) return;
    if (out.size() > 1 && out.back() == out.front()) out.pop_back();
    std::rotate(out.begin(), std::min_element(out.begin(), out.end()), out.end());
  }

  void in_any(const Edge& e, std::vector<std::uint32_t>& out) const {
    bool unbounded = false;
    for (const auto& item : e.cells) {
      out.push_back(t_.group(item.cell));
      for (unsigned j = 0; j <= k_ && k_ > 1; ++j)
        unbounded = unbounded || (t_.neighbours_of(item.cell)[j] == no_cell &&
                                  !on_edge(e, t_.cell(item.cell)[j]));
    }
    if (unbounded) out.push_back(at_infinity);
    std::sort(out.begin(), out.end());
    out.erase(std::unique(out.begin(), out.end()), out.end());
  }

  const DualPoints& p_;
  const Triangulation& t_;
  const GroupVertices& groups_;
  unsigned k_;
  std::vector<double> rows_;
};

}  // namespace

EdgeCells::EdgeCells(const Triangulation& t, const Run& run) : begin_(t.point_count + 1) {
  const unsigned m = t.corners();
  std::fill(begin_.begin(), begin_.end(), 0U);
  const auto each = [&](std::uint64_t c, const auto& body) {
    const auto v = t.cell(c);
    for (unsigned i = 0; i < m; ++i)
      for (unsigned j = i + 1; j < m; ++j) body(std::min(v[i], v[j]), std::max(v[i], v[j]));
  };
  for (std::uint64_t c = 0; c < t.size(); ++c)
    each(c, [&](std::uint32_t low, std::uint32_t) { ++begin_[low + 1]; });
  for (std::uint64_t i = 0; i < t.point_count; ++i) begin_[i + 1] += begin_[i];
  items_.resize(begin_.back());
  Array<std::uint64_t> at(begin_);
  for (std::uint64_t c = 0; c < t.size(); ++c) {
    if (c % light_grain == 0) run.check();
    each(c, [&](std::uint32_t low, std::uint32_t high) {
      items_[at[low]++] = {high, static_cast<std::uint32_t>(c)};
    });
  }
  run.each(t.point_count, light_grain / 8, [&](std::uint64_t begin, std::uint64_t end) {
    for (std::uint64_t v = begin; v < end; ++v)
      std::sort(items_.data() + begin_[v], items_.data() + begin_[v + 1],
                [](const Item& a, const Item& b) {
                  return a.other != b.other ? a.other < b.other : a.cell < b.cell;
                });
  });
}

PointNeighbours::PointNeighbours(const Triangulation& t, const Run& run)
    : begin_(t.point_count + 1) {
  const EdgeCells edges(t, run);
  std::fill(begin_.begin(), begin_.end(), 0U);
  const auto each = [&](const auto& body) {
    for (std::uint64_t v = 0; v < t.point_count; ++v) {
      std::uint32_t last = no_point;
      for (const auto& item : edges.of(v)) {
        if (item.other != last) body(static_cast<std::uint32_t>(v), item.other);
        last = item.other;
      }
    }
  };
  each([&](std::uint32_t a, std::uint32_t b) {
    ++begin_[a + 1];
    ++begin_[b + 1];
  });
  for (std::uint64_t v = 0; v < t.point_count; ++v) begin_[v + 1] += begin_[v];
  items_.resize(begin_.back());
  Array<std::uint64_t> at(begin_);
  // Lower neighbours come first, in order, as rows ascend; then the higher ones.
  each([&](std::uint32_t a, std::uint32_t b) { items_[at[b]++] = a; });
  each([&](std::uint32_t a, std::uint32_t b) { items_[at[a]++] = b; });
}

void write_ridges(const DualPoints& p, const Triangulation& t, Voronoi& out, const Run& run) {
  const EdgeCells edges(t, run);
  const GroupVertices groups(t);
  ListsInChunks vertices(t.point_count), points(t.point_count);
  run.each_chunk(t.point_count, vertices.grain,
                 [&](std::uint64_t chunk, std::uint64_t begin, std::uint64_t end) {
                   RidgeWriter writer(p, t, groups);
                   std::vector<std::uint32_t> ridge;
                   for (std::uint64_t v = begin; v < end; ++v) {
                     const auto around = edges.of(v);
                     for (std::size_t i = 0; i < around.size();) {
                       std::size_t next = i + 1;
                       while (next < around.size() && around[next].other == around[i].other) ++next;
                       const Edge e{static_cast<std::uint32_t>(v), around[i].other,
                                    around.subspan(i, next - i)};
                       if (writer.write(e, ridge)) {
                         vertices.add(chunk, ridge);
                         points.add(chunk, {e.low, e.high});
                       }
                       i = next;
                     }
                   }
                 });
  vertices.join(out.ridge_offsets, out.ridge_vertices);
  Array<std::uint64_t> pairs;
  points.join(pairs, out.ridge_points);
}

}  // namespace cullhull::internal
