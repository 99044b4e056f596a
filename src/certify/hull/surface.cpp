// Checks of shape, flat, ridges and covering number: does the surface bound a convex polytope?
#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <numeric>

#include "certify/certificate.hpp"
#include "certify/hull/cones.hpp"
#include "exact/numbers/gmpxx.hpp"
#include "exact/numbers/rationals.hpp"
#include "parallel/dispatch.hpp"
#include "parallel/threads/parallel.hpp"

namespace cullhull::internal::certify {
namespace {

constexpr std::uint64_t chunk = std::uint64_t{1} << 12;  // up to a millisecond of work

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
  check_chunks(s.run, s.ids.size(), chunk, [&](std::uint64_t begin, std::uint64_t end) {
    for (std::uint64_t i = begin; i < end; ++i) {
      if (s.ids[i] >= s.points.count) fault("vertex ", s.ids[i], " is out of range");
      if (i > 0 && s.ids[i - 1] >= s.ids[i]) fault("vertices are not in ascending order");
    }
  });
  s.position = IdPlaces(s.ids, s.run);
  const unsigned d = h.dimension;
  s.full.resize(s.ids.size() * d);
  const double infinity = std::numeric_limits<double>::infinity();
  std::vector<double> lows(chunk_count(s.ids.size(), chunk) * d, infinity),
      highs(lows.size(), -infinity);
  check_chunks(s.run, s.ids.size(), chunk, [&](std::uint64_t begin, std::uint64_t end) {
    double* const low = lows.data() + begin / chunk * d;
    double* const high = highs.data() + begin / chunk * d;
    for (std::uint64_t i = begin; i < end; ++i)
      for (unsigned j = 0; j < d; ++j) {
        const double x = s.claimed != nullptr ? (*s.claimed)[i * d + j] : s.points.at(s.ids[i], j);
        if (!std::isfinite(x)) fault("point ", s.ids[i], " is not finite");
        s.full[i * d + j] = x;
        low[j] = std::min(low[j], x);
        high[j] = std::max(high[j], x);
      }
  });
  s.low.assign(d, infinity);
  s.high.assign(d, -infinity);
  for (std::size_t i = 0; i < lows.size(); ++i) {
    s.low[i % d] = std::min(s.low[i % d], lows[i]);
    s.high[i % d] = std::max(s.high[i % d], highs[i]);
  }
}

void read_simplices(Subject& s) {
  const Hull& h = s.hull;
  const unsigned k = s.k;
  const std::uint64_t count = h.simplex_facets.size();
  s.index.resize(count * k);
  std::vector<std::uint8_t> used(s.ids.size(), 0);
  check_chunks(s.run, count, chunk, [&](std::uint64_t begin, std::uint64_t end) {
    for (std::uint64_t i = begin; i < end; ++i) {
      const std::uint64_t* row = h.simplices.data() + i * k;
      for (unsigned j = 0; j < k; ++j) {
        const std::uint32_t at = s.position(row[j]);
        if (at == s.ids.size()) fault("simplex ", i, " uses point ", row[j], ", not a vertex");
        s.index[i * k + j] = at;
        const std::atomic_ref<std::uint8_t> mark(used[at]);  // threads may share a vertex
        if (mark.load(std::memory_order_relaxed) == 0) mark.store(1, std::memory_order_relaxed);
        // Ascending; the last two may be swapped.
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
  for (std::size_t v = 0; v < used.size(); ++v)
    if (!used[v]) fault("vertex ", s.ids[v], " is on no simplex");
}

/// How simplex b meets simplex a across the ridge opposite to vertex i of a. `slot`: of b, opposite
/// to that ridge (k if they share none). `coherent`: both have the same orientation, which means
/// that the permutation from a's order (its vertex i replaced by b's) to b's order is odd. K: k if
/// known at compile time, else 0; `at` has room for k.
struct Across {
  unsigned slot;
  bool coherent;
};
template <unsigned K>
Across across(unsigned dynamic_k, const std::uint32_t* a, unsigned i, const std::uint32_t* b,
              unsigned* at) {
  const unsigned k = K != 0 ? K : dynamic_k;
  Across result{k, false};
  unsigned strangers = 0;
  for (unsigned j = 0; j < k; ++j) {
    unsigned place = k;
    for (unsigned c = 0; c < k; ++c) place = a[c] == b[j] ? c : place;
    const bool shared = place < k && place != i;
    strangers += !shared;
    result.slot = shared ? result.slot : j;
    at[j] = shared ? place : i;
  }
  if (strangers != 1) return {k, false};
  for (unsigned j = 1; j < k; ++j)
    for (unsigned c = 0; c < j; ++c) result.coherent ^= at[c] > at[j];
  return result;
}

/// Checks ridges between simplices, each once, from the simplex with the lower number.
class RidgeCheck {
 public:
  RidgeCheck(const Subject& s, const Cones& cones) : s_(s), cones_(cones) {}

  /// Returns the number of ridges.
  std::uint64_t run() const {
    std::vector<std::uint64_t> pairs(chunk_count(s_.simplex_count(), chunk), 0);
    check_chunks(s_.run, s_.simplex_count(), chunk, [&](std::uint64_t begin, std::uint64_t end) {
      pairs[begin / chunk] = range(begin, end);
    });
    const std::uint64_t all = std::accumulate(pairs.begin(), pairs.end(), std::uint64_t{0});
    // No slot is in two pairs, so all slots are paired if there are twice as many slots as pairs.
    if (all * 2 != std::uint64_t{s_.simplex_count()} * s_.k) name_the_odd_one();
    return all;
  }

 private:
  std::uint64_t range(std::uint64_t begin, std::uint64_t end) const {
    return with_dimension<2, 8, 0>(cones_.usable() ? s_.k : 0,
                                   [&](auto k) { return range_in<k>(begin, end); });
  }

  /// K: k if planes in doubles are usable, else 0.
  template <unsigned K>
  std::uint64_t range_in(std::uint64_t begin, std::uint64_t end) const {
    const unsigned k = K != 0 ? K : s_.k;
    std::vector<const double*> scratch(k + 1);
    std::vector<unsigned> at(k);
    std::uint64_t pairs = 0;
    for (std::uint64_t wide = begin; wide < end; ++wide) {
      const auto f = static_cast<std::uint32_t>(wide);
      for (unsigned i = 0; i < k; ++i) {
        const std::uint32_t g = s_.neighbour(f, i);
        if (g == f) not_neighbours(f, g);
        if (g < f) continue;
        const Across to = across<K>(k, s_.simplex(f), i, s_.simplex(g), at.data());
        if (to.slot == k || s_.neighbour(g, to.slot) != f) not_neighbours(f, g);
        if (!to.coherent) fault("simplices ", f, " and ", g, " are oriented differently");
        ++pairs;
        check_convex<K>(f, g, s_.row(s_.simplex(g)[to.slot]), scratch.data());
      }
    }
    return pairs;
  }

  template <unsigned K>
  void check_convex(std::uint32_t f, std::uint32_t g, const double* apex,
                    const double** scratch) const {
    Sign side = Sign::zero;
    bool known = false;
    if constexpr (K != 0) {
      double y[K];
      known = cones_.relative(apex, y) && cones_.strictly_beneath<K>(f, y);
    }
    side = known ? Sign::negative : s_.side(f, apex, scratch);
    const bool same = s_.hull.simplex_facets[f] == s_.hull.simplex_facets[g];
    if (side == Sign::positive) fault("the ridge of simplices ", f, " and ", g, " is not convex");
    if (side == Sign::zero && !same)
      fault("simplices ", f, " and ", g, " are coplanar, but of different facets");
    if (side != Sign::zero && same)
      fault("simplices ", f, " and ", g, " of facet ", s_.hull.simplex_facets[f],
            " are not coplanar");
  }

  [[noreturn]] static void not_neighbours(std::uint32_t f, std::uint32_t g) {
    fault("simplices ", f, " and ", g, " do not share a ridge as neighbours");
  }
  /// Finds a slot whose neighbour of lower number does not refer back to it.
  [[noreturn]] void name_the_odd_one() const {
    std::vector<unsigned> at(s_.k);
    for (std::uint32_t f = 0; f < s_.simplex_count(); ++f)
      for (unsigned i = 0; i < s_.k; ++i) {
        const std::uint32_t g = s_.neighbour(f, i);
        const unsigned slot = across<0>(s_.k, s_.simplex(f), i, s_.simplex(g), at.data()).slot;
        if (slot == s_.k || s_.neighbour(g, slot) != f) not_neighbours(f, g);
      }
    fault("neighbours do not come in pairs");
  }

  const Subject& s_;
  const Cones& cones_;
};

/// Whether the centre, or else the centroid of the basis, is strictly beneath every simplex; for
/// the centroid a negative answer is a fault.
bool beneath_all(const Subject& s, const Cones& cones) {
  const std::uint32_t count = s.simplex_count();
  try {
    check_chunks(s.run, count, chunk, [&](std::uint64_t begin, std::uint64_t end) {
      std::vector<const double*> scratch(s.k + 1);
      for (std::uint64_t f = begin; f < end; ++f) {
        if (cones.usable() && cones.beneath(static_cast<std::uint32_t>(f))) continue;
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

/// The mean of `count` vertices, rounded; null: of the first ones.
std::vector<double> mean(const Subject& s, const std::uint32_t* vertices, std::uint64_t count) {
  const unsigned k = s.k;
  const auto n = static_cast<double>(count);
  std::vector<double> sums(chunk_count(count, chunk) * k, 0), all(k, 0);
  check_chunks(s.run, count, chunk, [&](std::uint64_t begin, std::uint64_t end) {
    double* const sum = sums.data() + begin / chunk * k;
    for (std::uint64_t i = begin; i < end; ++i) {
      const double* row = s.row(vertices != nullptr ? vertices[i] : static_cast<std::uint32_t>(i));
      for (unsigned j = 0; j < k; ++j) sum[j] += row[j] / n;  // cannot overflow
    }
  });
  for (std::size_t i = 0; i < sums.size(); ++i) all[i % k] += sums[i];
  return all;
}

/// Tries the rounded means of all vertices and of the basis as interior point.
void choose_centre(Subject& s, Cones& cones) {
  for (const bool all : {true, false}) {
    s.centre = all ? mean(s, nullptr, s.ids.size()) : mean(s, s.basis.data(), s.basis.size());
    cones.place();
    if (beneath_all(s, cones)) return;
  }
  s.centre.clear();
  cones.drop();
  beneath_all(s, cones);
}

/// Excludes simplices by a few operations: linear functionals L with L(x) > 0 > L(v) for all
/// corners v of a simplex prove that its closed cone does not contain the ray towards x.
class Wedges {
 public:
  /// Wedges around the direction of x; excludes nothing if planes in doubles are not usable.
  Wedges(const Subject& s, const Cones& cones, const double* x) : s_(s) {
    if (!cones.usable()) return;
    const unsigned k = s.k;
    double y[Cones::max_dimension];
    if (!cones.relative(x, y)) return;
    add_functionals(y);
    behind_.resize(s.ids.size());
    check_chunks(s.run, s.ids.size(), chunk, [&](std::uint64_t begin, std::uint64_t end) {
      double v[Cones::max_dimension];
      for (std::uint64_t i = begin; i < end; ++i) {
        cones.relative(s.row(static_cast<std::uint32_t>(i)), v);
        std::uint32_t mask = 0;
        for (std::size_t l = 0; l * k < functionals_.size(); ++l)
          mask |= std::uint32_t{value(l, v) < 0} << l;
        behind_[i] = mask;
      }
    });
  }

  bool surely_misses(std::uint32_t f) const {
    if (behind_.empty()) return false;
    std::uint32_t common = ~0U;
    for (unsigned j = 0; j < s_.k; ++j) common &= behind_[s_.simplex(f)[j]];
    return common != 0;
  }

 private:
  /// Adds y, and steep functionals that bound a narrow pyramid around it: two along each axis.
  void add_functionals(const double* y) {
    constexpr double slope = 0x1p-6;
    const unsigned k = s_.k;
    double square = 0;
    for (unsigned c = 0; c < k; ++c) square += y[c] * y[c];
    if (!(square > 0x1p-100)) return;
    const double length = std::sqrt(square);
    for (unsigned c = 0; c < k; ++c) functionals_.push_back(y[c] / length);
    for (unsigned axis = 0; axis < k; ++axis)
      for (const double sign : {1.0, -1.0}) {
        const std::size_t begin = functionals_.size();
        for (unsigned c = 0; c < k; ++c)
          functionals_.push_back(sign * ((c == axis) - y[axis] / length * (y[c] / length)) +
                                 slope * (y[c] / length));
        if (!(-value(begin / k, y, -1) > 0)) functionals_.resize(begin);
      }
    if (!(-value(0, y, -1) > 0)) functionals_.clear();
  }
  /// An upper bound of L(v) for a rounded v; with sign -1 of -L(v).
  double value(std::size_t l, const double* v, double sign = 1) const {
    const unsigned k = s_.k;
    double sum = 0, terms = 0;
    for (unsigned c = 0; c < k; ++c) {
      const double term = functionals_[l * k + c] * v[c];
      sum += term;
      terms += std::fabs(term);
    }
    return sign * sum + (k + 4) * 0x1p-53 * terms + 0x1p-1000;
  }

  const Subject& s_;
  std::vector<double> functionals_;    ///< rows of k
  std::vector<std::uint32_t> behind_;  ///< for each vertex: bit l is set if L_l(v) < 0
};

/// Whether the closed cone over simplex f, from the centroid of the basis, contains the mean of the
/// corners of `target`; in rational arithmetic.
bool rational_cone(const Subject& s, std::uint32_t f, std::uint32_t target) {
  const unsigned k = s.k;
  std::vector<mpq_class> centroid(k), ray(k);
  for (unsigned c = 0; c < k; ++c) {
    for (const std::uint32_t v : s.basis) centroid[c] += mpq_class(s.row(v)[c]);
    centroid[c] /= k + 1;
    for (unsigned j = 0; j < k; ++j) ray[c] += mpq_class(s.row(s.simplex(target)[j])[c]);
    ray[c] = ray[c] / k - centroid[c];
  }
  // Solves sum lambda_j (corner j - centroid) = ray; the matrix is regular, as f is strictly
  // beneath.
  RationalRows m(k, std::vector<mpq_class>(k + 1));
  for (unsigned c = 0; c < k; ++c) {
    for (unsigned j = 0; j < k; ++j) m[c][j] = mpq_class(s.row(s.simplex(f)[j])[c]) - centroid[c];
    m[c][k] = ray[c];
  }
  return solves_without_negatives(m);
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
    if (std::find(s.simplex(0), s.simplex(0) + k, v) != s.simplex(0) + k) continue;
    rows[k] = full(v);
    if (affine_rank_exact(d, rows.data(), k + 1, s.axes.data()) != k) continue;
    s.basis.assign(s.simplex(0), s.simplex(0) + k);
    s.basis.push_back(v);
  }
  if (s.basis.empty()) fault("the vertices span fewer than ", k, " dimensions");
  s.axes.resize(k);
  if (k == d) return;
  for (std::uint32_t v = 0; v < s.ids.size(); ++v)
    for (const unsigned a : s.axes) s.projected.push_back(full(v)[a]);
}

void check_interior(Subject& s, Cones& cones) {
  if (s.k > 1) choose_centre(s, cones);
}

std::uint64_t check_ridges(const Subject& s, const Cones& cones) {
  if (s.k > 1) return RidgeCheck(s, cones).run();
  if (s.simplex_count() != 2 || s.neighbour(0, 0) != 1 || s.neighbour(1, 0) != 0)
    fault("a segment has two ends, neighbours of one another");
  if (s.hull.simplex_facets[0] != 0 || s.hull.simplex_facets[1] != 1)
    fault("each end of a segment is a facet");
  return 1;
}

/// Checks that the ray through some simplex meets no other. Since every simplex is seen from
/// beneath, the number of simplices that a ray meets is how often the surface covers the sphere of
/// directions.
void check_covering(Subject& s, Cones& cones) {
  if (s.k == 1) return;
  std::vector<const double*> scratch(s.k + 1);
  // A double strictly inside the cone of some simplex.
  std::vector<double> x;
  std::uint32_t target = 0;
  for (; target < s.simplex_count(); ++target) {
    const std::uint32_t* v = s.simplex(target);
    x = mean(s, v, s.k);
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
    cones.drop();
    beneath_all(s, cones);
  }
  const Wedges wedges(s, cones, x.data());
  check_chunks(s.run, s.simplex_count(), chunk, [&](std::uint64_t begin, std::uint64_t end) {
    std::vector<const double*> own(s.k + 1);
    for (std::uint64_t wide = begin; wide < end; ++wide) {
      const auto f = static_cast<std::uint32_t>(wide);
      if (f == target || wedges.surely_misses(f)) continue;
      if (rational ? rational_cone(s, f, target) : s.in_cone(f, x.data(), own.data()))
        fault("a ray meets simplices ", target, " and ", f, ": the surface covers itself");
    }
  });
}

/// The facets of k + 1 vertices of rank k are the sets that lack one of them, and the sides on
/// which the others lie follow from one sign by permutations: in many dimensions signs take
/// milliseconds.
std::uint64_t check_single_simplex(const Subject& s) {
  const unsigned k = s.k;
  std::vector<const double*> scratch(k + 1);
  std::vector<std::uint32_t> order(k + 1);  // of facet f: its vertices, then the one it lacks
  std::vector<std::uint32_t> facet_without(k + 1, k + 1);
  bool outward = false;
  for (std::uint32_t f = 0; f <= k; ++f) {
    std::copy_n(s.simplex(f), k, order.begin());
    std::uint32_t sum = k * (k + 1) / 2;
    for (unsigned j = 0; j < k; ++j) sum -= order[j];
    order[k] = sum;  // ids of a simplex differ, as check_shape saw
    if (facet_without[sum] != k + 1)
      fault("simplices ", facet_without[sum], " and ", f, " are equal");
    facet_without[sum] = f;
    unsigned inversions = 0;
    for (unsigned j = 1; j <= k; ++j)
      for (unsigned c = 0; c < j; ++c) inversions += order[c] > order[j];
    const bool odd = inversions % 2 != 0;
    if (f == 0) outward = odd == (s.side(0, s.row(sum), scratch.data()) == Sign::negative);
    if (odd != outward) fault("the vertices are not beneath simplex ", f);
  }
  for (std::uint32_t f = 0; f <= k; ++f)
    for (unsigned j = 0; j < k; ++j)
      if (s.neighbour(f, j) != facet_without[s.simplex(f)[j]])
        fault("simplices ", f, " and ", s.neighbour(f, j), " do not share a ridge as neighbours");
  if (s.hull.facets.size() != std::uint64_t{k} + 1)
    fault("the facets of a simplex are ", k + 1, ", not ", s.hull.facets.size());
  return std::uint64_t{k} * (k + 1) / 2;
}

}  // namespace cullhull::internal::certify
