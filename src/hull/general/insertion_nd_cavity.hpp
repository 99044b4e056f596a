// A part of insertion_nd.hpp: finds the cavity of a point, replaces it by new facets, and collects
// the final surface.
#pragma once

#include <cstring>

#include "geometry/simplex.hpp"
#include "hull/general/insertion_nd.hpp"
#include "parallel/adjacency.hpp"
#include "parallel/prefetch.hpp"
#include "parallel/scan.hpp"

namespace cullhull::internal {

// ----------------------------------------------------------------------------------- insertion

/// Finds the facets visible from the point and their border. False if another lane holds some.
template <unsigned D>
template <bool shared>
bool InsertionNd<D>::find_cavity(Lane& lane, Id seed, Id point) {
  const unsigned d = dim();
  // A local copy, which no store below can alias, stays in registers.
  float copy[D > 0 ? D : 1];
  const float* y = lane.offset.data();
  if constexpr (D > 0) y = std::copy_n(y, D, copy) - D;
  // Prefetch distance in facets: larger where cavities have hundreds of facets.
  constexpr std::size_t early = D == 4 || D == 5 ? 2 : 6;
  std::size_t visible = 1, ridges = 0;
  lane.visible.resize(std::max<std::size_t>(lane.visible.size(), 64));
  lane.horizon.resize(std::max<std::size_t>(lane.horizon.size(), 64));
  lane.visible[0] = seed;
  store_.template seen<shared>(seed) = 1;
  for (std::size_t k = 0; k < visible; ++k) {
    if (visible + d > lane.visible.size()) lane.visible.resize(2 * lane.visible.size() + d);
    if (ridges + d > lane.horizon.size()) lane.horizon.resize(2 * lane.horizon.size() + d);
    if (k % 4096 == 4095) run_.check();
    Id* const list = lane.visible.data();
    HorizonRidge* const horizon = lane.horizon.data();
    const Id f = list[k];
    const Id* n = store_.neighbours(f);
    if (shared && !hold_all(lane, n)) {
      for (std::size_t i = 0; i < visible; ++i) store_.template seen<shared>(list[i]) = 0;
      return false;
    }
    // Which neighbours are visible is unpredictable, so no branch depends on it. A facet beyond the
    // horizon is tested once for each of its horizon ridges, which costs less than remembering it.
    for (unsigned first = 0; first < d; first += 32) {
      std::uint32_t all = seen_among(lane, y, n, first, point);
      for (unsigned j = first; j < std::min(d, first + 32); ++j, all >>= 1) {
        const Id other = n[j];
        std::uint8_t& mark = store_.template seen<shared>(other);
        const std::uint32_t seen = all & 1U, known = mark;
        mark = static_cast<std::uint8_t>(known | seen);
        list[visible] = other;
        visible += seen & ~known;
        horizon[ridges] = {f, other, static_cast<std::uint8_t>(j), 0};
        ridges += 1 - seen;
      }
    }
    // Prefetch the facets that are `early` places from being processed.
    if (k + early < visible) {
      const Id* next = store_.neighbours(list[k + early]);
      for (unsigned j = 0; j < d; ++j) store_.template prefetch<shared>(next[j]);
    }
  }
  lane.visible.resize(visible);
  lane.seen = visible;
  lane.horizon.resize(ridges);
  for (const Id f : lane.visible) store_.template seen<shared>(f) = 0;
  for (std::size_t k = 0; k < ridges; ++k) {
    if (k + ahead < ridges) prefetch_line(store_.neighbours(lane.horizon[k + ahead].outside));
    HorizonRidge& r = lane.horizon[k];
    r.back = static_cast<std::uint8_t>(index_of(store_.neighbours(r.outside), r.facet));
  }
  return true;
}

/// Makes a new facet on every horizon ridge. New facets first reuse the slots of the visible ones,
/// so neighbours stay near in memory and hints stay valid.
template <unsigned D>
void InsertionNd<D>::replace(Lane& lane, Id point) {
  const unsigned d = dim();
  const std::size_t count = lane.horizon.size();
  lane.vertices.resize(count * d);
  lane.neighbours.resize(count * d);
  lane.apex.resize(count);
  lane.planes.resize(count * (d + 1));
  for (std::size_t k = 0; k < count; ++k) {
    if (k + ahead < count) prefetch_line(store_.vertices(lane.horizon[k + ahead].facet));
    const HorizonRidge& r = lane.horizon[k];
    Id* v = lane.vertices.data() + k * d;
    std::memcpy(v, store_.vertices(r.facet), d * sizeof(Id));
    v[r.apex] = point;
    lane.apex[k] = r.apex;
    store_.neighbours(r.facet)[r.apex] = static_cast<Id>(k) | horizon_tag;
  }
  lane.pairs.find<D>(d, lane.vertices.data(), lane.apex.data(), count, lane.neighbours.data(),
                     [&](std::size_t k, unsigned i) { return turn(lane, k, i); });
  run_.check();
  if constexpr (D == 0) {
    lane.wide.resize(count * (d + 1));
    for (std::size_t k = 0; k < count; ++k) {
      const HorizonRidge& r = lane.horizon[k];
      float* const plane = lane.planes.data() + k * (d + 1);
      double* const wide = lane.wide.data() + k * (d + 1);
      if (plane_between(frame_, store_.wide(r.facet), store_.wide(r.outside), point, plane, wide))
        continue;
      run_.check();  // beyond 8D the plane can take milliseconds
      facet_planes_any(frame_, lane.vertices.data() + k * d, 1, plane, wide);
    }
  } else {
    facet_planes(frame_, point, lane.vertices.data(), lane.apex.data(), count, lane.planes.data());
  }
  const Id* const slot = lane.visible.data();
  for (std::size_t k = count; k < lane.seen; ++k) {
    store_.vertices(slot[k])[0] = dead;
    lane.unused.push_back(slot[k]);
  }
  for (std::size_t k = 0; k < count; ++k) {
    if (k + ahead < count) {
      store_.prefetch_to_write(slot[k + ahead]);
      prefetch_line_to_write(store_.neighbours(lane.horizon[k + ahead].outside));
    }
    const HorizonRidge& r = lane.horizon[k];
    const Id f = slot[k];
    std::memcpy(store_.plane(f), lane.planes.data() + k * (d + 1), (d + 1) * sizeof(float));
    if constexpr (D == 0)
      std::memcpy(store_.wide(f), lane.wide.data() + k * (d + 1), (d + 1) * sizeof(double));
    std::memcpy(store_.vertices(f), lane.vertices.data() + k * d, d * sizeof(Id));
    Id* n = store_.neighbours(f);
    const Id* local = lane.neighbours.data() + k * d;
    for (unsigned i = 0; i < d; ++i) n[i] = slot[local[i]];
    n[r.apex] = r.outside;
    store_.neighbours(r.outside)[r.back] = f;
  }
  lane.hint = slot[0];
  ++lane.inserted;
  lane.made += count;
  lane.removed += lane.seen;
}

/// The new facet across the ridge of new facet k opposite to vertex i. Found by rotating, through
/// visible facets, about the face spanned by the horizon ridge of facet k without vertex i.
template <unsigned D>
typename InsertionNd<D>::Id InsertionNd<D>::turn(const Lane& lane, std::size_t k,
                                                 unsigned i) const {
  Id at = lane.horizon[k].facet, kept_vertex = store_.vertices(at)[lane.horizon[k].apex];
  unsigned exit = i;
  for (;;) {
    const Id next = store_.neighbours(at)[exit];
    if ((next & horizon_tag) != 0) return next & ~horizon_tag;
    const Id* v = store_.vertices(next);
    exit = index_of(v, kept_vertex);
    kept_vertex = v[index_of(store_.neighbours(next), at)];
    at = next;
  }
}

/// Whether the wide planes prove that every ridge between f and a facet in a later slot is strictly
/// convex: one of the two planes has the other facet's vertex off the ridge strictly beneath it.
/// Planes must also fit their own vertices.
template <unsigned D>
bool InsertionNd<D>::proved_convex(Id f) const requires(D == 0) {
  const unsigned d = dim();
  const Id *v = store_.vertices(f), *n = store_.neighbours(f);
  const WideGauge plane(frame_, store_.wide(f));
  for (unsigned j = 0; j < d; ++j)
    if (!plane.may_contain(v[j])) return false;
  for (unsigned j = 0; j < d; ++j) {
    if (n[j] < f) continue;
    const Id across = store_.vertices(n[j])[index_of(store_.neighbours(n[j]), f)];
    if (!plane.surely_beneath(across) && !WideGauge(frame_, store_.wide(n[j])).surely_beneath(v[j]))
      return false;
  }
  return true;
}

/// Sorts the vertices of each facet, and numbers facets in the order of their vertices: as the
/// facets of a surface without ties are the same in whatever order points were inserted, so are
/// their numbers.
template <unsigned D>
void InsertionNd<D>::number_canonically(RawArray<Id>& number) {
  const unsigned d = dim();
  constexpr std::uint64_t chunk = std::uint64_t{1} << 12;
  run_.each(facet_slots_, chunk, [&](std::uint64_t begin, std::uint64_t end) {
    for (auto f = static_cast<Id>(begin); f < end; ++f)
      if (number[f] != no_index) sort_simplex<D, true>(store_.vertices(f), store_.neighbours(f), d);
  });
  Adjacency<Id, Id> by_first(order_.size(), [&](const auto& add) {
    for (Id f = 0; f < facet_slots_; ++f)
      if (number[f] != no_index) add(store_.vertices(f)[0], f);
  });
  run_.each(by_first.size(), chunk, [&](std::uint64_t begin, std::uint64_t end) {
    for (std::uint64_t v = begin; v < end; ++v) {
      const auto list = by_first.list(v);
      std::sort(list.begin(), list.end(), [&](Id f, Id g) {
        const Id *a = store_.vertices(f), *b = store_.vertices(g);
        return std::lexicographical_compare(a, a + d, b, b + d);
      });
      for (const Id& f : list) number[f] = static_cast<Id>(&f - by_first.items().data());
    }
  });
}

template <unsigned D>
Boundary InsertionNd<D>::collect() {
  const unsigned d = dim();
  // A facet's number: the count of live facets in earlier chunks, plus those before it in its own.
  constexpr unsigned chunk_bits = 12;
  constexpr std::uint64_t chunk = std::uint64_t{1} << chunk_bits;
  RawArray<Id> number;
  number.reserve(facet_slots_);
  auto live =
      sum_chunks<Id>(facet_slots_, chunk, run_, [&](std::uint64_t begin, std::uint64_t end) {
        Id count = 0;
        for (std::uint64_t f = begin; f < end; ++f)
          number[f] = store_.alive(static_cast<Id>(f)) ? count++ : no_index;
        return count;
      });
  if (same_facets_) {
    number_canonically(number);
    std::fill(live.before.begin(), live.before.end(), 0);
  }
  if constexpr (D == 0) {
    result_.doubtful.resize(same_facets_ ? 0 : live.total);  // it is of no use to samples
    run_.each_chunk(facet_slots_, chunk,
                    [&](std::uint64_t c, std::uint64_t begin, std::uint64_t end) {
      for (std::uint64_t f = begin; f < end; ++f)
        if (number[f] != no_index && !same_facets_)
          result_.doubtful[live.before[c] + number[f]] = !proved_convex(static_cast<Id>(f));
    });
  }
  ordered_.release();
  store_.release_planes();
  result_.dimension = d;
  result_.vertices.resize(std::size_t{live.total} * d);
  result_.neighbours.resize(std::size_t{live.total} * d);
  run_.each_chunk(facet_slots_, chunk,
                  [&](std::uint64_t c, std::uint64_t begin, std::uint64_t end) {
    for (std::uint64_t f = begin; f < end; ++f) {
      if (number[f] == no_index) continue;
      const std::size_t base = std::size_t{live.before[c] + number[f]} * d;
      const Id* v = store_.vertices(static_cast<Id>(f));
      const Id* n = store_.neighbours(static_cast<Id>(f));
      for (unsigned j = 0; j < d; ++j) {
        result_.vertices[base + j] = order_[v[j]];
        result_.neighbours[base + j] = live.before[n[j] >> chunk_bits] + number[n[j]];
      }
    }
  });
  for (const Lane& lane : lanes_) {
    result_.rung_counts += lane.rung_counts;
    result_.duplicates.insert(result_.duplicates.end(), lane.duplicates.begin(),
                              lane.duplicates.end());
  }
  return std::move(result_);
}

}  // namespace cullhull::internal
