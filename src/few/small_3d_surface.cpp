#include "few/small_3d_surface.hpp"

#include <algorithm>
#include <bit>

namespace cullhull::internal {
namespace {

/// Merges coplanar simplices into facets, and traces their borders.
template <class Surface>
class Merger {
  using Number = typename Surface::Number;
  static constexpr unsigned capacity = Surface::capacity;

 public:
  Merger(Surface& surface, const Number* names, MergedFacets<Surface>& out)
      : surface_(surface), names_(names), out_(out) {}

  void run(const CoplanarPair<Surface>* pairs, unsigned pair_count) {
    for (unsigned f = 0; f < surface_.top; ++f) group_[f] = static_cast<Number>(f);
    for (unsigned i = 0; i < pair_count; ++i) join(pairs[i].a, pairs[i].b);
    list_groups();
    for (unsigned i = 0; i < group_count_; ++i) {
      number_[groups_[i]] = static_cast<Number>(i);
      out_.start[i] = end_;
      if (next_in_group_[groups_[i]] == groups_[i])
        take_simplex(groups_[i]);
      else
        trace(groups_[i]);
      lowest_first(out_.start[i]);
    }
    out_.count = group_count_;
    out_.start[group_count_] = end_;
    for (unsigned i = 0; i < end_; ++i) out_.across[i] = number_[out_.across[i]];
    write_fans();
  }

 private:
  unsigned root(unsigned f) const {
    while (group_[f] != f) f = group_[f];
    return f;
  }
  void join(unsigned a, unsigned b) {
    a = root(a), b = root(b);
    group_[std::max(a, b)] = static_cast<Number>(std::min(a, b));
  }

  /// Links the members of each group in a ring.
  void list_groups() {
    for (unsigned f = 0; f < surface_.top; ++f) {
      if (!surface_.live(f)) continue;
      const unsigned r = root(f);  // r < f, so its ring exists already
      group_[f] = static_cast<Number>(r);
      next_in_group_[f] = static_cast<Number>(f);
      if (r == f)
        groups_[group_count_++] = static_cast<Number>(f);
      else
        std::swap(next_in_group_[f], next_in_group_[r]);
    }
  }

  void take_simplex(unsigned f) {
    unsigned v[3];
    surface_.corners(f, v);
    for (unsigned j = 0; j < 3; ++j) put(v[j], group_[surface_.across(f, v, j)]);
  }

  void put(unsigned corner, unsigned across) {
    out_.corner[end_] = names_[corner];
    out_.across[end_++] = static_cast<Number>(across);
  }

  /// Traces the border of a facet. A vertex of it is extreme exactly if it is on a third facet,
  /// that is, if the facets across its two edges differ.
  void trace(unsigned first) {
    unsigned at = 0, f = first;
    do {
      unsigned v[3];
      surface_.corners(f, v);
      for (unsigned j = 0; j < 3; ++j) {
        const unsigned to = v[j == 2 ? 0 : j + 1];
        const unsigned g = group_[surface_.across(f, v, j)];
        if (g == first) continue;
        at = v[j];
        follower_[at] = static_cast<Number>(to);
        beyond_[at] = static_cast<Number>(g);
      }
      f = next_in_group_[f];
    } while (f != first);
    for (const unsigned facet = beyond_[at]; beyond_[at] == facet;) at = follower_[at];
    const unsigned begin = at;
    do {
      const unsigned facet = beyond_[at];
      put(at, facet);
      while (beyond_[at] == facet) at = follower_[at];
    } while (at != begin);
  }

  void lowest_first(unsigned begin) {
    const auto by = static_cast<unsigned>(
        std::min_element(out_.corner + begin, out_.corner + end_) - (out_.corner + begin));
    std::rotate(out_.corner + begin, out_.corner + begin + by, out_.corner + end_);
    std::rotate(out_.across + begin, out_.across + begin + by, out_.across + end_);
  }

  void write_fans() {
    unsigned f = 0;
    Number first[capacity];
    for (unsigned i = 0; i < out_.count; ++i) {
      const Number* v = out_.corner + out_.start[i];
      first[i] = static_cast<Number>(f);
      for (unsigned j = 2; j < out_.start[i + 1] - out_.start[i]; ++j) {
        surface_.set(f, v[0], v[j - 1], v[j]);
        out_.of_simplex[f++] = static_cast<Number>(i);
      }
    }
    surface_.top = f;
    if constexpr (Surface::linked) link_fans(first);
  }

  unsigned size(unsigned polygon) const { return out_.start[polygon + 1] - out_.start[polygon]; }
  /// A simplex at an edge of a polygon, and the edge's number in it. `first`: the first simplex of
  /// each fan.
  struct Place {
    unsigned simplex, edge;
  };
  Place place(const Number* first, unsigned polygon, unsigned e) const {
    if (e == 0) return {first[polygon], 0};
    if (e + 1 == size(polygon)) return {first[polygon] + e - 2, 2};
    return {first[polygon] + e - 1, 1};
  }

  /// Links fans across the edges between polygons. An edge is searched in the polygon with fewer
  /// edges, which is cheap: two large polygons share only one edge.
  void link_fans(const Number* first) {
    for (unsigned i = 0; i < out_.count; ++i) {
      const unsigned begin = out_.start[i], edges = size(i);
      for (unsigned j = 3; j < edges; ++j) surface_.join(first[i] + j - 3, 2, first[i] + j - 2, 0);
      for (unsigned e = 0; e < edges; ++e) {
        const unsigned other = out_.across[begin + e];
        if (size(other) > edges || (size(other) == edges && other > i)) continue;
        const unsigned from = out_.corner[begin + e],
                       to = out_.corner[begin + (e + 1 == edges ? 0 : e + 1)];
        const unsigned rest = out_.start[other], count = size(other);
        unsigned k = 0;
        while (out_.corner[rest + k] != to ||
               out_.corner[rest + (k + 1 == count ? 0 : k + 1)] != from)
          ++k;
        const Place here = place(first, i, e), there = place(first, other, k);
        surface_.join(here.simplex, here.edge, there.simplex, there.edge);
      }
    }
  }

  Surface& surface_;
  const Number* names_;
  MergedFacets<Surface>& out_;
  unsigned group_count_ = 0, end_ = 0;
  Number group_[capacity], next_in_group_[capacity], groups_[capacity], number_[capacity];
  Number follower_[Surface::most_points], beyond_[Surface::most_points];  // along a border
};

/// Orders the facets by their first simplices. order[i]: the simplex of the surface that gets
/// number i.
template <class Surface>
void write_polygons(const MergedFacets<Surface>& polygons, const typename Surface::Number* order,
                    typename Surface::Hull& out) {
  using Number = typename Surface::Number;
  bool seen[Surface::capacity] = {};
  Number number[Surface::capacity], polygon[Surface::capacity];
  unsigned n = 0;
  for (unsigned i = 0; i < out.count; ++i) {
    const Number p = polygons.of_simplex[order[i]];
    if (!seen[p]) {
      seen[p] = true;
      polygon[n] = p;
      number[p] = static_cast<Number>(n++);
    }
    out.facet_of[i] = number[p];
  }
  out.facet_count = n;
  unsigned at = 0;
  for (unsigned i = 0; i < n; ++i) {
    const unsigned begin = polygons.start[polygon[i]], end = polygons.start[polygon[i] + 1U];
    out.facet_size[i] = static_cast<Number>(end - begin);
    for (unsigned j = begin; j < end; ++j, ++at) {
      out.corners[at] = polygons.corner[j];
      out.beside[at] = number[polygons.across[j]];
    }
  }
}

/// Facets whose lowest vertex is v are enumerated by a bit set of their second vertices: the facets
/// on the left of edges from v.
void sort_simplices(TableSurface& surface, unsigned point_count, TableSurface::Number* order,
                    SmallHull3D& out) {
  const unsigned words = (point_count + 63) / 64;
  std::uint64_t second[TableSurface::most_points][2];
  for (unsigned v = 0; v < point_count; ++v) second[v][0] = second[v][1] = 0;
  for (unsigned f = 0; f < surface.top; ++f) {
    const std::uint32_t key = surface.facets[f];
    if (key == TableSurface::none) continue;
    const std::uint32_t least =
        std::min({key, (key << 8 | key >> 16) & 0xFFFFFF, (key << 16 | key >> 8) & 0xFFFFFF});
    surface.facets[f] = least;
    second[least >> 16][least >> 14 & 1] |= std::uint64_t{1} << (least >> 8 & 63);
  }
  unsigned n = 0;
  for (unsigned v = 0; v < point_count; ++v)
    for (unsigned w = 0; w < words; ++w)
      for (std::uint64_t rest = second[v][w]; rest != 0; rest &= rest - 1) {
        const unsigned f = surface.owner[v][64 * w + static_cast<unsigned>(std::countr_zero(rest))];
        const std::uint32_t key = surface.facets[f];
        order[n] = static_cast<TableSurface::Number>(f);
        auto* to = out.vertices + std::size_t{3} * n++;
        to[0] = static_cast<TableSurface::Number>(v);
        to[1] = static_cast<TableSurface::Number>(key >> 8);
        to[2] = static_cast<TableSurface::Number>(key);
      }
  out.count = n;
}

/// A counting sort by lowest vertex; the few simplices with the same one are inserted in the order
/// of their second vertex.
void sort_simplices(LinkedSurface& surface, unsigned point_count, LinkedSurface::Number* order,
                    MediumHull3D& out) {
  using Number = LinkedSurface::Number;
  unsigned start[LinkedSurface::most_points + 1] = {};
  for (unsigned f = 0; f < surface.top; ++f) {
    if (!surface.live(f)) continue;
    LinkedSurface::Facet& facet = surface.facets[f];
    const Number* v = facet.corner;
    const unsigned turn = v[0] < v[1] ? (v[0] < v[2] ? 0 : 2) : (v[1] < v[2] ? 1 : 2);
    std::rotate(facet.corner, facet.corner + turn, facet.corner + 3);
    std::rotate(facet.neighbour, facet.neighbour + turn, facet.neighbour + 3);
    ++start[facet.corner[0] + 1];
  }
  for (unsigned v = 0; v < point_count; ++v) start[v + 1] += start[v];
  out.count = start[point_count];
  unsigned end[LinkedSurface::most_points];
  std::copy_n(start, point_count, end);
  for (unsigned f = 0; f < surface.top; ++f) {
    if (!surface.live(f)) continue;
    const Number* v = surface.facets[f].corner;
    unsigned at = end[v[0]]++;
    for (; at > start[v[0]] && surface.facets[order[at - 1]].corner[1] > v[1]; --at)
      order[at] = order[at - 1];
    order[at] = static_cast<Number>(f);
  }
  for (unsigned i = 0; i < out.count; ++i)
    std::copy_n(surface.facets[order[i]].corner, 3, out.vertices + std::size_t{3} * i);
}

}  // namespace

template <class Surface>
void merge_small(Surface& surface, const CoplanarPair<Surface>* pairs, unsigned pair_count,
                 const typename Surface::Number* names, MergedFacets<Surface>& polygons) {
  Merger<Surface>(surface, names, polygons).run(pairs, pair_count);
}
template void merge_small(TableSurface&, const CoplanarPair<TableSurface>*, unsigned,
                          const TableSurface::Number*, MergedFacets<TableSurface>&);
template void merge_small(LinkedSurface&, const CoplanarPair<LinkedSurface>*, unsigned,
                          const LinkedSurface::Number*, MergedFacets<LinkedSurface>&);

template <class Surface>
void order_small(Surface& surface, unsigned point_count, const MergedFacets<Surface>* polygons,
                 typename Surface::Hull& out) {
  using Number = typename Surface::Number;
  Number rank[Surface::capacity], order[Surface::capacity], used[Surface::most_points] = {};
  sort_simplices(surface, point_count, order, out);
  const unsigned n = out.facet_count = out.count;
  for (unsigned i = 0; i < n; ++i) rank[order[i]] = static_cast<Number>(i);
  for (unsigned f = 0, i = 0; f < n; ++f, i += 3) {
    const unsigned v[3] = {out.vertices[i], out.vertices[i + 1], out.vertices[i + 2]};
    used[v[0]] = used[v[1]] = used[v[2]] = 1;
    const Number x = rank[surface.across(order[f], v, 1)], y = rank[surface.across(order[f], v, 2)],
                 z = rank[surface.across(order[f], v, 0)];
    out.opposite[i] = out.beside[i + 1] = x;
    out.opposite[i + 1] = out.beside[i + 2] = y;
    out.opposite[i + 2] = out.beside[i] = z;
  }
  for (unsigned i = 3 * n; i < (n + 7) / 8 * 24; ++i) out.vertices[i] = out.vertices[i - 3];
  out.vertex_count = 0;
  for (unsigned v = 0; v < point_count; ++v) {
    out.ids[out.vertex_count] = static_cast<Number>(v);
    out.vertex_count += used[v];
  }
  if (polygons != nullptr) write_polygons<Surface>(*polygons, order, out);
}
template void order_small(TableSurface&, unsigned, const MergedFacets<TableSurface>*, SmallHull3D&);
template void order_small(LinkedSurface&, unsigned, const MergedFacets<LinkedSurface>*,
                          MediumHull3D&);

}  // namespace cullhull::internal
