#include "hull/small_surface.hpp"

#include <algorithm>
#include <bit>

namespace cullhull::internal {
namespace {

using Number = SmallSurface::Number;
constexpr unsigned capacity = SmallSurface::capacity;

/// Joins the simplices of a facet, and follows its border.
class Merger {
 public:
  Merger(SmallSurface& surface, const std::uint8_t* names, SmallPolygons& out)
      : surface_(surface), names_(names), out_(out) {}

  void run(const CoplanarPair* pairs, unsigned pair_count) {
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

  /// The members of a group in a ring.
  void list_groups() {
    for (unsigned f = 0; f < surface_.top; ++f) {
      if (surface_.facets[f] == SmallSurface::none) continue;
      const unsigned r = root(f);  // lower, so that it came before
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
    SmallSurface::corners(surface_.facets[f], v);
    for (unsigned j = 0; j < 3; ++j) {
      const unsigned to = v[j == 2 ? 0 : j + 1];
      put(v[j], group_[surface_.owner[to][v[j]]]);
    }
  }

  void put(unsigned corner, unsigned across) {
    out_.corner[end_] = names_[corner];
    out_.across[end_++] = static_cast<Number>(across);
  }

  /// A vertex of the border is extreme exactly if it is on a third facet: if the facets across its
  /// two edges differ.
  void trace(unsigned first) {
    unsigned at = 0, f = first;
    do {
      unsigned v[3];
      SmallSurface::corners(surface_.facets[f], v);
      for (unsigned j = 0; j < 3; ++j) {
        const unsigned to = v[j == 2 ? 0 : j + 1];
        const unsigned g = group_[surface_.owner[to][v[j]]];
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
    for (unsigned i = 0; i < out_.count; ++i) {
      const Number* v = out_.corner + out_.start[i];
      for (unsigned j = 2; j < out_.start[i + 1] - out_.start[i]; ++j) {
        surface_.set(f, v[0], v[j - 1], v[j]);
        out_.of_simplex[f++] = static_cast<Number>(i);
      }
    }
    surface_.top = f;
  }

  SmallSurface& surface_;
  const std::uint8_t* names_;
  SmallPolygons& out_;
  unsigned group_count_ = 0, end_ = 0;
  Number group_[capacity], next_in_group_[capacity], groups_[capacity], number_[capacity];
  Number follower_[SmallSurface::most_points], beyond_[SmallSurface::most_points];  // of a border
};

}  // namespace

void merge_small(SmallSurface& surface, const CoplanarPair* pairs, unsigned pair_count,
                 const std::uint8_t* names, SmallPolygons& polygons) {
  Merger(surface, names, polygons).run(pairs, pair_count);
}

namespace {

/// The facets in the order of their first simplices. order[i]: which simplex of the surface is
/// number i.
void write_polygons(const SmallPolygons& polygons, const Number* order, SmallHull3D& out) {
  bool seen[capacity] = {};
  Number number[capacity], polygon[capacity];
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

}  // namespace

/// Facets whose lowest vertex is v are found by the bits of their second vertices, as those on the
/// left of edges from v.
void order_small(SmallSurface& surface, unsigned point_count, const SmallPolygons* polygons,
                 SmallHull3D& out) {
  const unsigned words = (point_count + 63) / 64;
  std::uint64_t second[SmallSurface::most_points][2];
  for (unsigned v = 0; v < point_count; ++v) second[v][0] = second[v][1] = 0;
  for (unsigned f = 0; f < surface.top; ++f) {
    const std::uint32_t key = surface.facets[f];
    if (key == SmallSurface::none) continue;
    const std::uint32_t least =
        std::min({key, (key << 8 | key >> 16) & 0xFFFFFF, (key << 16 | key >> 8) & 0xFFFFFF});
    surface.facets[f] = least;
    second[least >> 16][least >> 14 & 1] |= std::uint64_t{1} << (least >> 8 & 63);
  }
  Number rank[capacity], order[capacity], used[SmallSurface::most_points] = {};
  unsigned n = 0;
  for (unsigned v = 0; v < point_count; ++v)
    for (unsigned w = 0; w < words; ++w)
      for (std::uint64_t rest = second[v][w]; rest != 0; rest &= rest - 1) {
        const unsigned f = surface.owner[v][64 * w + static_cast<unsigned>(std::countr_zero(rest))];
        const std::uint32_t key = surface.facets[f];
        rank[f] = static_cast<Number>(n);
        order[n] = static_cast<Number>(f);
        Number* to = out.vertices + std::size_t{3} * n++;
        to[0] = static_cast<Number>(v);
        to[1] = static_cast<Number>(key >> 8);
        to[2] = static_cast<Number>(key);
      }
  out.count = out.facet_count = n;
  for (unsigned i = 0; i < 3 * n; i += 3) {
    const unsigned a = out.vertices[i], b = out.vertices[i + 1], c = out.vertices[i + 2];
    used[a] = used[b] = used[c] = 1;
    const Number x = rank[surface.owner[c][b]], y = rank[surface.owner[a][c]],
                 z = rank[surface.owner[b][a]];
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
  if (polygons != nullptr) write_polygons(*polygons, order, out);
}

}  // namespace cullhull::internal
