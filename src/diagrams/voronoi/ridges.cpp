// The ridges of a diagram, dual to the triangulation's edges that are not inside merged cells; in
// the plane the regions, too, by one walk around each point.
#include <algorithm>
#include <utility>
#include <vector>

#include "diagrams/dual.hpp"
#include "exact/orientation/orientation.hpp"
#include "geometry/simplex.hpp"
#include "parallel/index.hpp"

namespace cullhull::internal {
namespace {

/// The vertices of each group of merged cells, ascending.
class GroupVertices {
 public:
  GroupVertices(const Triangulation& t, const Run& run) {
    if (t.cell_groups.empty()) return;
    const unsigned m = t.corners();
    const std::size_t groups = *std::max_element(t.cell_groups.begin(), t.cell_groups.end()) + 1ULL;
    vertices_ = Adjacency<std::uint32_t>(groups, [&](const auto& add) {
      for (std::uint64_t c = 0; c < t.size(); ++c)
        for (const std::uint32_t v : t.cell(c)) add(t.group(c), v);
    });
    count_.resize(groups);
    run.each(groups, light_grain / 8, [&](std::uint64_t first, std::uint64_t last) {
      for (std::uint64_t g = first; g < last; ++g) {
        const std::span<std::uint32_t> own = vertices_.list(g);
        if (own.size() == m) {
          count_[g] = 0;  // one cell
          continue;
        }
        std::sort(own.begin(), own.end());
        count_[g] = static_cast<std::uint32_t>(std::unique(own.begin(), own.end()) - own.begin());
      }
    });
  }
  /// Whether group g has more than one cell.
  bool merged(std::uint32_t g) const { return !count_.empty() && count_[g] > 0; }
  /// Whether v is one of the vertices of group g, which has more than one cell.
  bool has(std::uint32_t g, std::uint32_t v) const {
    const auto own = vertices_[g].first(count_[g]);
    return std::binary_search(own.begin(), own.end(), v);
  }

 private:
  Adjacency<std::uint32_t> vertices_;
  Array<std::uint32_t> count_;  ///< number of distinct vertices, which come first; 0: one cell
};

// ------------------------------------------------------------------------------- in the plane

/// For each point the lowest cell at it; no_index without any.
Array<std::uint32_t> lowest_cells(const Triangulation& t) {
  Array<std::uint32_t> lowest(t.point_count, no_index);
  for (auto c = static_cast<std::uint32_t>(t.size()); c-- > 0;)
    for (const std::uint32_t v : t.cell(c)) lowest[v] = c;
  return lowest;
}

/// The lists of a chunk of points, one after another.
struct PlaneLists {
  std::vector<std::uint32_t> ridge_points, ridges, regions;
  std::vector<std::uint64_t> region_ends;
};

/// Walks around points, whose lists it adds to others.
class PlaneWalk {
 public:
  PlaneWalk(const Triangulation& t, PlaneLists& out) : t_(t), out_(out) {}

  /// Adds the region of v, and the ridges between it and higher points. `start`: a cell at v.
  ///
  /// The edge to a corner is a ridge unless both cells at it are of one group. At the hull it is
  /// always one: the corners of a group are extreme points of the lift, so no three of them are on
  /// a line of the plane.
  void add(std::uint32_t v, std::uint32_t start) {
    std::vector<std::uint32_t>& regions = out_.regions;
    const std::size_t before = regions.size();
    higher_.clear();
    if (start != no_index) {
      const std::uint32_t first = most_clockwise(v, start);
      if (first_is_open_) regions.push_back(at_infinity);
      std::uint32_t right = first_is_open_ ? at_infinity : t_.group(across(first, v, 2));
      std::uint64_t steps = 0;
      for (std::uint32_t c = first;;) {
        const std::uint32_t group = t_.group(c);
        const unsigned at = place_in(t_.cell(c), v);
        add_ridge(v, t_.cell(c)[(at + 1) % 3], group, right);
        if (regions.size() == before || regions.back() != group) regions.push_back(group);
        right = group;
        const std::uint32_t next = t_.neighbours_of(c)[(at + 1) % 3];
        if (next == no_index) add_ridge(v, t_.cell(c)[(at + 2) % 3], at_infinity, right);
        if (next == no_index || next == first) break;
        if (++steps > t_.size()) bad_neighbours();
        c = next;
      }
      if (!first_is_open_) begin_with_lowest(before);
    }
    out_.region_ends.push_back(regions.size());
    std::sort(higher_.begin(), higher_.end(),
              [](const Ridge& a, const Ridge& b) { return a.high < b.high; });
    for (const Ridge& ridge : higher_) {
      out_.ridge_points.push_back(v);
      out_.ridge_points.push_back(ridge.high);
      out_.ridges.push_back(ridge.left);
      out_.ridges.push_back(ridge.right);
    }
  }

 private:
  /// Seen from the lower point.
  struct Ridge {
    std::uint32_t high, left, right;
  };

  std::uint32_t across(std::uint32_t c, std::uint32_t v, unsigned turn) const {
    return t_.neighbours_of(c)[(place_in(t_.cell(c), v) + turn) % 3];
  }
  /// For a point on the hull the cell from which a counterclockwise walk meets all others at it;
  /// else `start`.
  std::uint32_t most_clockwise(std::uint32_t v, std::uint32_t start) {
    first_is_open_ = false;
    std::uint32_t first = start;
    std::uint64_t steps = 0;
    for (std::uint32_t c = across(start, v, 2); c != start; c = across(c, v, 2)) {
      if (++steps > t_.size()) bad_neighbours();
      if (c == no_index) {
        first_is_open_ = true;
        return first;
      }
      first = c;
    }
    return start;
  }
  void add_ridge(std::uint32_t v, std::uint32_t other, std::uint32_t left, std::uint32_t right) {
    if (other > v && left != right) higher_.push_back({other, left, right});
  }
  /// Of a closed region, which is a cycle.
  void begin_with_lowest(std::size_t begin) {
    std::vector<std::uint32_t>& regions = out_.regions;
    if (regions.size() > begin + 1 && regions.back() == regions[begin]) regions.pop_back();
    const auto own = regions.begin() + static_cast<std::ptrdiff_t>(begin);
    std::rotate(own, std::min_element(own, regions.end()), regions.end());
  }

  const Triangulation& t_;
  PlaneLists& out_;
  bool first_is_open_ = false;
  std::vector<Ridge> higher_;
};

/// Writes ridges and regions, for k = 2.
void write_plane(const Triangulation& t, Voronoi& out, const Run& run) {
  const Array<std::uint32_t> lowest = lowest_cells(t);
  const std::uint64_t grain = light_grain / 16;
  std::vector<PlaneLists> parts(chunk_count(t.point_count, grain));
  parts[0].region_ends.push_back(0);
  run.each_chunk(t.point_count, grain,
                 [&](std::uint64_t chunk, std::uint64_t begin, std::uint64_t end) {
    PlaneLists& own = parts[chunk];
    // Three ridges and six corners a point, on average at most.
    own.ridge_points.reserve(6 * (end - begin));
    own.ridges.reserve(6 * (end - begin));
    own.regions.reserve(6 * (end - begin));
    own.region_ends.reserve(end - begin);
    PlaneWalk walk(t, own);
    for (std::uint64_t v = begin; v < end; ++v) walk.add(static_cast<std::uint32_t>(v), lowest[v]);
  });
  out.ridge_points = join_items(parts, &PlaneLists::ridge_points, run);
  Array<std::uint32_t> ridges = join_items(parts, &PlaneLists::ridges, run);
  out.ridges = Lists<std::uint32_t>::of_length(2, std::move(ridges));
  out.regions = join_lists(parts, &PlaneLists::regions, &PlaneLists::region_ends, run);
}

// ------------------------------------------------------------------------ in other dimensions

class RidgeWriter {
 public:
  RidgeWriter(const DualPoints& p, const Triangulation& t, const GroupVertices& groups)
      : p_(p), t_(t), groups_(groups), k_(t.corners() - 1) {}

  /// Writes the vertices of the edge's ridge; false if the edge has no ridge of dimension k - 1.
  bool write(const EdgeCells::Star& e, std::vector<std::uint32_t>& out) {
    out.clear();
    if (within_merged(e)) return false;
    if (k_ == 3)
      in_space(e, out);
    else
      in_any(e, out);
    return true;
  }

 private:
  bool on_edge(const EdgeCells::Star& e, std::uint32_t v) const {
    return v == e.low || v == e.high;
  }

  /// Whether the edge is not an edge of the merged complex: the least face of the complex that
  /// contains it has further vertices. These are common to all groups around the edge, and in the
  /// planes of all hull facets at it. Since vertices are extreme points of the lift, such a face
  /// has dimension 2 or more, and the cells of each group divide it into simplices. So in each
  /// group some cell at the edge has such a further vertex; it suffices to test the corners of the
  /// group that has the fewest cells here.
  bool within_merged(const EdgeCells::Star& e) {
    if (k_ < 3) return false;
    bool any = false;
    for (const auto& item : e.cells) any = any || groups_.merged(t_.group(item.cell));
    if (!any) return false;
    sort_by_group(e);
    std::size_t least = 0, fewest = e.cells.size() + 1;
    for (std::size_t i = 0, next = 0; i < around_.size(); i = next) {
      while (next < around_.size() && around_[next].first == around_[i].first) ++next;
      if (next - i < fewest) {
        fewest = next - i;
        least = i;
      }
    }
    candidates_.clear();
    for (std::size_t i = least; i < least + fewest; ++i)
      for (const std::uint32_t v : t_.cell(around_[i].second))
        if (!on_edge(e, v)) candidates_.push_back(v);
    std::sort(candidates_.begin(), candidates_.end());
    candidates_.erase(std::unique(candidates_.begin(), candidates_.end()), candidates_.end());
    return std::any_of(candidates_.begin(), candidates_.end(),
                       [&](std::uint32_t v) { return in_all_groups(v) && on_hull(e, v); });
  }
  void sort_by_group(const EdgeCells::Star& e) {
    around_.clear();
    for (const auto& item : e.cells) around_.emplace_back(t_.group(item.cell), item.cell);
    std::sort(around_.begin(), around_.end());
  }
  /// Whether v is a vertex of all groups around the edge.
  bool in_all_groups(std::uint32_t v) const {
    for (std::size_t i = 0; i < around_.size(); ++i) {
      const auto [group, c] = around_[i];
      if (i > 0 && group == around_[i - 1].first) continue;
      const auto cell = t_.cell(c);
      if (!(groups_.merged(group) ? groups_.has(group, v)
                                  : std::find(cell.begin(), cell.end(), v) != cell.end()))
        return false;
    }
    return true;
  }

  /// Whether v is in the planes of all hull facets that contain the edge.
  bool on_hull(const EdgeCells::Star& e, std::uint32_t v) {
    for (const auto& item : e.cells)
      for (unsigned j = 0; j <= k_; ++j) {
        if (t_.neighbours_of(item.cell)[j] != no_index || on_edge(e, t_.cell(item.cell)[j]))
          continue;
        if (!on_plane(item.cell, j, v)) return false;
      }
    return true;
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

  /// The slots of the cell's corners that are not on the edge, in counterclockwise order around the
  /// direction from low to high.
  std::pair<unsigned, unsigned> others(const EdgeCells::Star& e, std::uint32_t c) const {
    const auto v = t_.cell(c);
    std::uint32_t order[4], n = 2;
    for (unsigned i = 0; i < 4; ++i) order[v[i] == e.low ? 0 : v[i] == e.high ? 1 : n++] = i;
    std::uint32_t sorted[4];
    std::copy_n(order, 4, sorted);
    if (sort_simplex<0>(sorted, nullptr, 4)) std::swap(order[2], order[3]);
    return {order[2], order[3]};
  }

  void in_space(const EdgeCells::Star& e, std::vector<std::uint32_t>& out) const {
    std::uint32_t first = e.cells[0].cell;
    for (const auto& item : e.cells) {  // infinity first
      if (!at_hull(e, item.cell)) continue;
      if (t_.neighbours_of(item.cell)[others(e, item.cell).second] != no_index) continue;
      out.push_back(at_infinity);
      first = item.cell;
    }
    // The way leaves each cell opposite to the corner that it shares with the cell before.
    const auto [begin, end] = others(e, first);
    std::uint32_t kept = t_.cell(first)[end];
    unsigned leave = begin;
    std::size_t left = e.cells.size();
    for (std::uint32_t c = first;;) {
      if (left-- == 0) bad_neighbours();
      if (out.empty() || out.back() != t_.group(c)) out.push_back(t_.group(c));
      c = t_.neighbours_of(c)[leave];
      if (c == no_index || c == first) break;
      const auto v = t_.cell(c);
      std::uint32_t added = kept;
      for (unsigned i = 0; i < 4; ++i) {
        if (v[i] == kept)
          leave = i;
        else if (!on_edge(e, v[i]))
          added = v[i];
      }
      kept = added;
    }
    if (out.front() == at_infinity) return;
    if (out.size() > 1 && out.back() == out.front()) out.pop_back();
    std::rotate(out.begin(), std::min_element(out.begin(), out.end()), out.end());
  }
  /// Whether the cell has a facet without a neighbour that contains the edge.
  bool at_hull(const EdgeCells::Star& e, std::uint32_t c) const {
    const auto v = t_.cell(c), across = t_.neighbours_of(c);
    for (unsigned i = 0; i <= k_; ++i)
      if (across[i] == no_index && !on_edge(e, v[i])) return true;
    return false;
  }

  void in_any(const EdgeCells::Star& e, std::vector<std::uint32_t>& out) const {
    bool unbounded = false;
    for (const auto& item : e.cells) {
      out.push_back(t_.group(item.cell));
      for (unsigned j = 0; j <= k_ && k_ > 1; ++j)
        unbounded = unbounded || (t_.neighbours_of(item.cell)[j] == no_index &&
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
  std::vector<std::pair<std::uint32_t, std::uint32_t>> around_;  ///< group and cell, at the edge
  std::vector<std::uint32_t> candidates_;
};

}  // namespace

void write_ridges(const DualPoints& p, const Triangulation& t,
                  const Adjacency<std::uint32_t>& stars, Voronoi& out, const Run& run) {
  if (t.corners() == 3) {
    write_plane(t, out, run);
    return;
  }
  const EdgeCells edges(t, stars);
  const GroupVertices groups(t, run);
  ChunkedListBuilder vertices(t.point_count), points(t.point_count);
  run.each_chunk(t.point_count, vertices.grain,
                 [&](std::uint64_t chunk, std::uint64_t begin, std::uint64_t end) {
    RidgeWriter writer(p, t, groups);
    std::vector<std::uint32_t> ridge;
    edges.each_edge(begin, end, [&](const EdgeCells::Star& e) {
      if (!writer.write(e, ridge)) return;
      vertices.add(chunk, ridge);
      const std::uint32_t ends[2] = {e.low, e.high};
      points.add(chunk, ends);
    });
  });
  out.ridges = vertices.join(run);
  out.ridge_points = points.join(run).items;
}

}  // namespace cullhull::internal
