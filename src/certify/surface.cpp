// Shape, flat, ridges and covering number: that the surface is the boundary of a convex polytope.
#include <gmpxx.h>

#include <algorithm>
#include <cmath>

#include "certify/certificate.hpp"

namespace cullhull::internal {
namespace {

constexpr std::uint64_t chunk = std::uint64_t{1} << 14;

template <class T, class Items>
void check_lists(const Lists<T, Items>& lists, const char* name) {
  const auto& o = lists.offsets;
  if (o.empty() || o.front() != 0 || o.back() != lists.items.size() ||
      !std::is_sorted(o.begin(), o.end()))
    fault("the offsets of ", name, " do not fit its items");
}

void check_sizes(const Subject& s) {
  const Hull& h = s.hull;
  const std::uint64_t simplices = h.simplex_facets.size();
  if (simplices < s.k + std::uint64_t{1}) fault("too few simplices: ", simplices);
  if (simplices >= 0xFFFFFFFFU) fault("too many simplices: ", simplices);
  if (h.simplices.size() != simplices * s.k || h.simplex_neighbours.size() != simplices * s.k)
    fault("simplices, simplex_neighbours and simplex_facets differ in length");
  check_lists(h.facets, "facets");
  check_lists(h.facet_neighbours, "facet_neighbours");
  const std::uint64_t facets = h.facets.size();
  if (facets != h.facet_neighbours.size() || facets > simplices ||
      h.facet_planes.size() != facets * (std::uint64_t{h.dimension} + 1))
    fault("facets, facet_neighbours and facet_planes differ in length");
  if (h.centroid.size() != h.dimension) fault("the centroid has the wrong dimension");
  if (h.vertices.size() < s.k + std::uint64_t{1} || h.vertices.size() >= 0xFFFFFFFFU)
    fault("the number of vertices is impossible: ", h.vertices.size());
}

void read_vertices(Subject& s) {
  const Hull& h = s.hull;
  s.ids = h.vertices;
  if (s.k == 2) {
    std::sort(s.ids.begin(), s.ids.end());
    if (h.vertices[0] != s.ids[0]) fault("vertices do not begin with the lowest id");
  }
  for (std::size_t i = 0; i < s.ids.size(); ++i) {
    if (s.ids[i] >= s.points.count) fault("vertex ", s.ids[i], " is out of range");
    if (i > 0 && s.ids[i - 1] >= s.ids[i]) fault("vertices are not in ascending order");
  }
  s.index_ids();
  const unsigned d = h.dimension;
  s.full.resize(s.ids.size() * d);
  check_chunks(s, s.ids.size(), chunk, [&](std::uint64_t begin, std::uint64_t end) {
    for (std::uint64_t i = begin; i < end; ++i)
      for (unsigned j = 0; j < d; ++j) {
        s.full[i * d + j] =
            s.claimed != nullptr ? (*s.claimed)[i * d + j] : s.points.at(s.ids[i], j);
        if (!std::isfinite(s.full[i * d + j])) fault("point ", s.ids[i], " is not finite");
      }
  });
}

void read_simplices(Subject& s) {
  const Hull& h = s.hull;
  const unsigned k = s.k;
  const std::uint64_t count = h.simplex_facets.size();
  s.index.resize(count * k);
  check_chunks(s, count, chunk, [&](std::uint64_t begin, std::uint64_t end) {
    for (std::uint64_t i = begin; i < end; ++i) {
      const std::uint64_t* row = h.simplices.data() + i * k;
      for (unsigned j = 0; j < k; ++j) {
        const std::uint64_t at = s.position(row[j]);
        if (at == s.ids.size()) fault("simplex ", i, " uses point ", row[j], ", not a vertex");
        s.index[i * k + j] = static_cast<std::uint32_t>(at);
        // Ascending, but the last two may be swapped.
        if (j > 0 && (j + 1 < k ? row[j - 1] >= row[j] : row[j - 1] == row[j]))
          fault("the ids of simplex ", i, " are not in order");
        if (j + 1 == k && k > 2 && row[j] <= row[k - 3])
          fault("the ids of simplex ", i, " are not in order");
        if (h.simplex_neighbours[i * k + j] >= count)
          fault("a neighbour of simplex ", i, " is out of range");
      }
      if (i > 0 && !std::lexicographical_compare(row - k, row, row, row + k))
        fault("simplices ", i - 1, " and ", i, " are not in ascending order");
      if (h.simplex_facets[i] >= h.facets.size())
        fault("the facet of simplex ", i, " is out of range");
    }
  });
  std::vector<std::uint8_t> used(s.ids.size(), 0);
  for (const std::uint32_t v : s.index) used[v] = 1;
  for (std::size_t v = 0; v < used.size(); ++v)
    if (!used[v]) fault("vertex ", s.ids[v], " is on no simplex");
}

/// The slot of g opposite to the ridge that f shares with it across slot i.
unsigned opposite_slot(const Subject& s, std::uint32_t f, unsigned i, std::uint32_t g) {
  const std::uint32_t* a = s.simplex(f);
  const std::uint32_t* b = s.simplex(g);
  unsigned odd = s.k;
  for (unsigned j = 0; j < s.k; ++j) {
    const std::uint32_t* at = std::find(a, a + s.k, b[j]);
    const bool shared = at != a + s.k && at != a + i;
    if (shared) continue;
    if (odd != s.k) odd = s.k + 1;
    if (odd == s.k) odd = j;
  }
  if (f == g || odd >= s.k || s.neighbour(g, odd) != f)
    fault("simplices ", f, " and ", g, " do not share a ridge as neighbours");
  return odd;
}

/// Whether replacing vertex i of f by vertex j of g reverses the orientation, as it must where the
/// two lie side by side: the permutation from f's order to g's, with one for the other, is odd.
bool coherent(const Subject& s, std::uint32_t f, unsigned i, std::uint32_t g, unsigned j,
              std::vector<std::uint32_t>& order) {
  const std::uint32_t* b = s.simplex(g);
  order.assign(s.simplex(f), s.simplex(f) + s.k);
  order[i] = b[j];
  bool odd = false;
  for (unsigned c = 0; c < s.k; ++c) {
    if (order[c] == b[c]) continue;
    const auto at = std::find(order.begin() + c, order.end(), b[c]);
    std::iter_swap(order.begin() + c, at);
    odd = !odd;
  }
  return odd;
}

/// Tries the rounded means of some vertices as interior point.
bool beneath_all(const Subject& s) {
  const std::uint32_t count = s.simplex_count();
  try {
    check_chunks(s, count, chunk, [&](std::uint64_t begin, std::uint64_t end) {
      std::vector<const double*> scratch(s.k + 1);
      for (std::uint64_t f = begin; f < end; ++f) {
        s.prefetch_corners(f);
        for (unsigned j = 0; j < s.k; ++j)
          scratch[j] = s.row(s.simplex(static_cast<std::uint32_t>(f))[j]);
        if (s.seen(scratch.data()) != Sign::negative)
          fault("an interior point is not strictly beneath simplex ", f);
      }
    });
  } catch (const Fault&) {
    if (s.centre.empty()) throw;
    return false;
  }
  return true;
}

std::vector<double> mean(const Subject& s, const std::vector<std::uint32_t>& vertices) {
  std::vector<double> m(s.k, 0);
  const auto n = static_cast<double>(vertices.size());
  for (const std::uint32_t v : vertices)
    for (unsigned j = 0; j < s.k; ++j) m[j] += s.row(v)[j] / n;  // cannot overflow
  return m;
}

void choose_centre(Subject& s) {
  std::vector<std::uint32_t> all(s.ids.size());
  for (std::uint32_t v = 0; v < all.size(); ++v) all[v] = v;
  s.centre = mean(s, all);
  if (beneath_all(s)) return;
  s.centre = mean(s, s.basis);
  if (beneath_all(s)) return;
  s.centre.clear();
  beneath_all(s);
}

/// Whether the closed cone over simplex f contains the mean of the corners of `target`, seen from
/// the centroid of the basis, in rational arithmetic.
bool rational_cone(const Subject& s, std::uint32_t f, std::uint32_t target) {
  const unsigned k = s.k;
  std::vector<mpq_class> centroid(k), ray(k);
  for (unsigned c = 0; c < k; ++c) {
    for (const std::uint32_t v : s.basis) centroid[c] += mpq_class(s.row(v)[c]);
    centroid[c] /= k + 1;
    for (unsigned j = 0; j < k; ++j) ray[c] += mpq_class(s.row(s.simplex(target)[j])[c]);
    ray[c] = ray[c] / k - centroid[c];
  }
  // Solve sum lambda_j (corner j - centroid) = ray; simplex f is strictly beneath, so regular.
  std::vector<std::vector<mpq_class>> m(k, std::vector<mpq_class>(k + 1));
  for (unsigned c = 0; c < k; ++c) {
    for (unsigned j = 0; j < k; ++j) m[c][j] = mpq_class(s.row(s.simplex(f)[j])[c]) - centroid[c];
    m[c][k] = ray[c];
  }
  for (unsigned c = 0; c < k; ++c) {
    unsigned pivot = c;
    while (pivot < k && m[pivot][c] == 0) ++pivot;
    if (pivot == k) return true;
    std::swap(m[pivot], m[c]);
    for (unsigned r = 0; r < k; ++r) {
      if (r == c || m[r][c] == 0) continue;
      const mpq_class factor = m[r][c] / m[c][c];
      for (unsigned j = c; j <= k; ++j) m[r][j] -= factor * m[c][j];
    }
  }
  for (unsigned c = 0; c < k; ++c)
    if (m[c][k] * m[c][c] < 0) return false;
  return true;
}

/// The ray through simplex `target` must meet no other: with every simplex seen from beneath, the
/// number met is the number of times the surface covers the sphere of directions.
void check_covering(Subject& s) {
  std::vector<const double*> scratch(s.k + 1);
  // A double strictly within the cone of some simplex.
  std::vector<double> x;
  std::uint32_t target = 0;
  for (; target < s.simplex_count(); ++target) {
    const std::uint32_t* v = s.simplex(target);
    x = mean(s, {v, v + s.k});
    bool inside = true;
    for (unsigned j = 0; j < s.k && inside; ++j) {
      for (unsigned i = 0; i < s.k; ++i) scratch[i] = i == j ? x.data() : s.row(v[i]);
      inside = s.seen(scratch.data()) == Sign::negative;
    }
    if (inside) break;
  }
  const bool rational = target == s.simplex_count();
  if (rational) {  // a hull about as thin as the spacing of doubles
    target = 0;
    s.centre.clear();
    beneath_all(s);
  }
  check_chunks(s, s.simplex_count(), chunk, [&](std::uint64_t begin, std::uint64_t end) {
    std::vector<const double*> own(s.k + 1);
    for (std::uint64_t f = begin; f < end; ++f)
      if (f != target &&
          (rational ? rational_cone(s, static_cast<std::uint32_t>(f), target)
                    : s.in_cone(static_cast<std::uint32_t>(f), x.data(), own.data())))
        fault("a ray meets simplices ", target, " and ", f, ": the surface covers itself");
  });
}

}  // namespace

void check_shape(Subject& s) {
  check_sizes(s);
  read_vertices(s);
  read_simplices(s);
}

void check_flat(Subject& s) {
  const unsigned d = s.hull.dimension, k = s.k;
  const auto full = [&](std::uint32_t v) { return s.full.data() + std::size_t{v} * d; };
  std::vector<const double*> rows;
  for (unsigned j = 0; j < k; ++j) rows.push_back(full(s.simplex(0)[j]));
  if (affine_rank_exact(d, rows.data(), k) + 1 != k) fault("simplex 0 is degenerate");
  s.axes.resize(d + std::size_t{1});
  rows.push_back(nullptr);
  for (std::uint32_t v = 0; v < s.ids.size() && s.basis.empty(); ++v) {
    rows[k] = full(v);
    if (affine_rank_exact(d, rows.data(), k + 1, s.axes.data()) != k) continue;
    s.basis.assign(s.simplex(0), s.simplex(0) + k);
    s.basis.push_back(v);
  }
  if (s.basis.empty()) fault("the vertices span fewer than ", k, " dimensions");
  s.axes.resize(k);
  if (k == d) {
    s.rows = s.full;
    return;
  }
  for (std::uint32_t v = 0; v < s.ids.size(); ++v)
    for (const unsigned a : s.axes) s.rows.push_back(full(v)[a]);
}

std::uint64_t check_ridges(const Subject& s) {
  const Hull& h = s.hull;
  if (s.k == 1) {
    if (s.simplex_count() != 2 || s.neighbour(0, 0) != 1 || s.neighbour(1, 0) != 0)
      fault("a segment has two ends, neighbours of one another");
    if (h.simplex_facets[0] != 0 || h.simplex_facets[1] != 1)
      fault("each end of a segment is a facet");
    return 1;
  }
  check_chunks(s, s.simplex_count(), chunk, [&](std::uint64_t begin, std::uint64_t end) {
    std::vector<const double*> scratch(s.k + 1);
    std::vector<std::uint32_t> order;
    for (std::uint64_t wide = begin; wide < end; ++wide) {
      const auto f = static_cast<std::uint32_t>(wide);
      s.prefetch(f);
      for (unsigned i = 0; i < s.k; ++i) {
        const std::uint32_t g = s.neighbour(f, i);
        const unsigned j = opposite_slot(s, f, i, g);
        if (g < f) continue;
        if (!coherent(s, f, i, g, j, order))
          fault("simplices ", f, " and ", g, " are oriented differently");
        const Sign side = s.side(f, s.row(s.simplex(g)[j]), scratch.data());
        const bool same = h.simplex_facets[f] == h.simplex_facets[g];
        if (side == Sign::positive)
          fault("the ridge of simplices ", f, " and ", g, " is not convex");
        if (side == Sign::zero && !same)
          fault("simplices ", f, " and ", g, " are coplanar, but of different facets");
        if (side != Sign::zero && same)
          fault("simplices ", f, " and ", g, " of facet ", h.simplex_facets[f],
                " are not coplanar");
      }
    }
  });
  return std::uint64_t{s.simplex_count()} * s.k / 2;
}

void check_interior(Subject& s) {
  if (s.k == 1) return;
  choose_centre(s);
  check_covering(s);
}

}  // namespace cullhull::internal
