#include "viewer/hull_shape.hpp"

#include <algorithm>
#include <utility>

#include "cullhull/error.hpp"
#include "cullhull/hull.hpp"
#include "parallel/random_stream.hpp"

namespace cullhull::viewer {
namespace {

using internal::mix64;
using Pair = std::pair<std::uint32_t, std::uint32_t>;

constexpr std::uint32_t absent = UINT32_MAX;

/// Maps point ids to positions among the chosen vertices of the hull.
class Positions {
 public:
  Positions(const Hull& hull, const std::vector<std::uint64_t>& chosen) {
    for (std::uint32_t i = 0; i < chosen.size(); ++i)
      sorted_.push_back({hull.vertices[chosen[i]], i});
    std::sort(sorted_.begin(), sorted_.end());
  }
  std::uint32_t of(std::uint64_t id) const {
    const auto it = std::lower_bound(sorted_.begin(), sorted_.end(), std::pair{id, 0U});
    return it == sorted_.end() || it->first != id ? absent : it->second;
  }

 private:
  std::vector<std::pair<std::uint64_t, std::uint32_t>> sorted_;
};

/// The position of a vertex if all vertices were chosen. Throws for other ids, which a file may
/// contain.
std::uint32_t position(const Positions& positions, std::uint64_t id) {
  const std::uint32_t p = positions.of(id);
  if (p == absent)
    throw Error(ErrorCode::bad_file, "the hull names point " + std::to_string(id) +
                                         ", which is not one of its vertices");
  return p;
}

/// Dimension 2: hull.vertices is the boundary in cyclic order.
void draw_polygon(HullShape& shape) {
  const auto n = static_cast<std::uint32_t>(shape.vertices.size());
  for (std::uint32_t i = 0; i < n; ++i) {
    shape.edges.insert(shape.edges.end(), {i, (i + 1) % n});
    if (i > 0 && i + 1 < n) shape.triangles.insert(shape.triangles.end(), {0U, i, i + 1});
  }
}

/// Dimension 3: a facet's vertices are in cyclic order; each edge belongs to two facets.
void draw_polyhedron(const Hull& hull, const Positions& positions, HullShape& shape) {
  for (const std::uint64_t id : hull.simplices) shape.triangles.push_back(position(positions, id));
  for (std::size_t s = 0; s < hull.simplex_count(); ++s)
    shape.facets.push_back(hull.simplex_facets[s]);
  const decltype(Hull::facets)& facets = hull.facets;
  for (std::size_t f = 0; f < facets.size(); ++f)
    for (std::uint64_t i = facets.offsets[f]; i < facets.offsets[f + 1]; ++i) {
      const std::uint64_t next = i + 1 < facets.offsets[f + 1] ? i + 1 : facets.offsets[f];
      const std::uint64_t a = facets.items[i], b = facets.items[next];
      if (a < b)
        shape.edges.insert(shape.edges.end(), {position(positions, a), position(positions, b)});
    }
}

/// A face of a polytope is the intersection of the facets that contain it, so two vertices are an
/// edge if no other vertex is on all facets that contain both.
class EdgeTest {
 public:
  explicit EdgeTest(const Hull& hull) : facets_(hull.facets) {
    const auto k = static_cast<std::uint64_t>(hull.affine_dimension);
    for (std::size_t f = 0; f < facets_.size(); ++f)
      simplicial_ = simplicial_ && facets_.offsets[f + 1] - facets_.offsets[f] == k;
    if (simplicial_) return;
    for (std::uint32_t f = 0; f < facets_.size(); ++f)
      for (std::uint64_t i = facets_.offsets[f]; i < facets_.offsets[f + 1]; ++i)
        incidences_.push_back({facets_.items[i], f});
    std::sort(incidences_.begin(), incidences_.end());
  }
  /// If all facets are simplices, every pair of a simplex's vertices is an edge.
  bool operator()(std::uint64_t a, std::uint64_t b) const {
    if (simplicial_) return true;
    std::vector<std::uint64_t> common, rest;
    bool first = true;
    auto i = around(a);
    for (auto j = around(b); i != incidences_.end() && j != incidences_.end() && i->first == a &&
                             j->first == b && (first || common.size() > 2);) {
      if (i->second != j->second) {
        ++(i->second < j->second ? i : j);
        continue;
      }
      const auto begin =
          facets_.items.begin() + static_cast<std::ptrdiff_t>(facets_.offsets[i->second]);
      const auto end =
          facets_.items.begin() + static_cast<std::ptrdiff_t>(facets_.offsets[i->second + 1]);
      if (std::exchange(first, false)) {
        common.assign(begin, end);
      } else {
        rest.clear();
        std::set_intersection(common.begin(), common.end(), begin, end, std::back_inserter(rest));
        common.swap(rest);
      }
      ++i, ++j;
    }
    return !first && common.size() == 2;
  }

 private:
  using Incidence = std::pair<std::uint64_t, std::uint32_t>;
  std::vector<Incidence>::const_iterator around(std::uint64_t id) const {
    return std::lower_bound(incidences_.begin(), incidences_.end(), Incidence{id, 0});
  }
  const decltype(Hull::facets)& facets_;
  std::vector<Incidence> incidences_;
  bool simplicial_ = true;
};

std::uint64_t pair_hash(Pair e) { return mix64(std::uint64_t{e.first} << 32 | e.second); }

/// Pairs of chosen vertices that share a simplex, each once. If there are more than about `most`,
/// those with the lowest hashes: a uniform sample, independent of order and of how many simplices
/// share a pair.
std::vector<Pair> simplex_pairs(const Hull& hull, const Positions& positions, std::uint64_t most,
                                bool& sampled) {
  const auto k = static_cast<std::size_t>(hull.affine_dimension);
  std::vector<Pair> pairs;
  std::vector<std::uint32_t> at(k);
  std::uint64_t threshold = UINT64_MAX;
  const auto tidy = [&] {
    std::sort(pairs.begin(), pairs.end());
    pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
  };
  for (std::size_t s = 0; s < hull.simplices.size(); s += k) {
    for (std::size_t i = 0; i < k; ++i) at[i] = positions.of(hull.simplices[s + i]);
    for (std::size_t i = 0; i < k; ++i)
      for (std::size_t j = 0; j < i; ++j) {
        if (at[i] == absent || at[j] == absent) continue;
        const Pair pair{std::min(at[i], at[j]), std::max(at[i], at[j])};
        if (pair_hash(pair) <= threshold) pairs.push_back(pair);
      }
    if (pairs.size() <= 16 * most + 4096) continue;
    tidy();
    while (pairs.size() > 4 * most) {
      threshold /= 2;
      std::erase_if(pairs, [&](Pair e) { return pair_hash(e) > threshold; });
      sampled = true;
    }
  }
  tidy();
  return pairs;
}

/// Dimension 4 and up. Every triangulation without additional vertices contains all edges, so only
/// pairs of vertices that share a simplex are candidates.
void draw_graph(const Hull& hull, const Positions& positions, std::uint64_t most,
                HullShape& shape) {
  std::vector<Pair> pairs = simplex_pairs(hull, positions, most, shape.edges_sampled);
  const EdgeTest is_edge(hull);
  std::erase_if(pairs, [&](Pair e) {
    return !is_edge(hull.vertices[shape.vertices[e.first]],
                    hull.vertices[shape.vertices[e.second]]);
  });
  if (pairs.size() > most) {
    std::sort(pairs.begin(), pairs.end(), [](Pair a, Pair b) {
      return std::pair{pair_hash(a), a} < std::pair{pair_hash(b), b};
    });
    pairs.resize(most);
    std::sort(pairs.begin(), pairs.end());
    shape.edges_sampled = true;
  }
  for (const Pair& e : pairs) shape.edges.insert(shape.edges.end(), {e.first, e.second});
}

/// The hull of the chosen vertices alone; with this many the difference is not visible.
HullShape simplified_shape(const Hull& hull, const std::vector<double>& rows,
                           const std::vector<std::uint64_t>& chosen) {
  const std::size_t d = hull.dimension;
  std::vector<double> some;
  some.reserve(chosen.size() * d);
  for (const std::uint64_t v : chosen)
    some.insert(some.end(), rows.begin() + static_cast<std::ptrdiff_t>(v * d),
                rows.begin() + static_cast<std::ptrdiff_t>((v + 1) * d));
  const Hull small = convex_hull(PointView::row_major(some.data(), chosen.size(), hull.dimension));
  HullShape shape = hull_shape(small, {}, {small.vertices.size(), 0});
  for (std::uint64_t& v : shape.vertices) v = chosen[small.vertices[v]];
  shape.facets.clear();  // they refer to the other hull
  shape.simplified = true;
  return shape;
}

/// The projection on three axes.
Shadow shadow_on(const std::vector<double>& rows, std::uint32_t dimension,
                 const std::vector<std::uint64_t>& vertices, const std::uint32_t (&axes)[3]) {
  std::vector<double> projected;
  projected.reserve(3 * vertices.size());
  for (const std::uint64_t v : vertices)
    for (const std::uint32_t axis : axes) projected.push_back(rows[v * dimension + axis]);
  const Hull hull = convex_hull(PointView::row_major(projected.data(), vertices.size(), 3));
  const HullShape shape = hull_shape(hull, {}, {hull.vertices.size(), 0});
  Shadow shadow{{axes[0], axes[1], axes[2]}, shape.edges, shape.triangles};
  for (auto* list : {&shadow.edges, &shadow.triangles})
    for (std::uint32_t& i : *list) i = static_cast<std::uint32_t>(hull.vertices[shape.vertices[i]]);
  return shadow;
}

}  // namespace

std::vector<Shadow> shadows(const std::vector<double>& rows, std::uint32_t dimension,
                            const std::vector<std::uint64_t>& vertices, std::uint32_t axes) {
  std::vector<Shadow> all;
  for (std::uint32_t a = 0; a < axes; ++a)
    for (std::uint32_t b = a + 1; b < axes; ++b)
      for (std::uint32_t c = b + 1; c < axes; ++c)
        all.push_back(shadow_on(rows, dimension, vertices, {a, b, c}));
  return all;
}

std::vector<std::uint64_t> fair_sample(std::uint64_t count, std::uint64_t most) {
  std::vector<std::uint64_t> ids(std::min(count, most));
  // floor(i count / m) without a product that overflows (m < 2^32).
  const auto bound = [&, m = ids.size()](std::uint64_t i) {
    return i * (count / m) + i * (count % m) / m;
  };
  for (std::uint64_t i = 0; i < ids.size(); ++i)
    ids[i] = bound(i) + mix64(i + 1) % (bound(i + 1) - bound(i));
  return ids;
}

HullShape hull_shape(const Hull& hull, const std::vector<double>& rows, const ShapeLimits& limits) {
  const std::vector<std::uint64_t> chosen = fair_sample(hull.vertices.size(), limits.vertices);
  const bool all = chosen.size() == hull.vertices.size();
  const int k = hull.affine_dimension;
  if (!all && k <= 3) return simplified_shape(hull, rows, chosen);
  HullShape shape;
  shape.vertices = chosen;
  const Positions positions(hull, chosen);
  if (k == 1) shape.edges = {0, 1};
  if (k == 2) draw_polygon(shape);
  if (k == 3) draw_polyhedron(hull, positions, shape);
  if (k >= 4) draw_graph(hull, positions, limits.edges, shape);
  return shape;
}

}  // namespace cullhull::viewer
