// A part of insertion_nd.hpp: finds the cavity of a point, replaces it by new facets, and collects
// the final surface.
#pragma once

#include <cstring>

#include "hull/general/insertion_nd.hpp"
#include "parallel/prefetch.hpp"
#include "parallel/scan.hpp"

namespace cullhull::internal {

// ----------------------------------------------------------------------------------- insertion

template <unsigned D>
void InsertionNd<D>::find_cavity(Stream& s, Lane& lane, Id seed) const {
  const unsigned d = dim();
  if (lane.visited_size < facet_slots_) lane.cover(facet_capacity_);
  std::uint8_t* visited = lane.visited.data();
  // A local copy, which no store below can alias, stays in registers.
  float copy[D > 0 ? D : 1];
  const float* y = lane.offset.data();
  if constexpr (D > 0) y = std::copy_n(y, D, copy) - D;
  // Prefetch distance in facets: larger where cavities have hundreds of facets.
  constexpr std::size_t early = D == 4 || D == 5 ? 2 : 6;
  std::size_t visible = 1, ridges = 0;
  s.visible.resize(std::max<std::size_t>(s.visible.size(), 64));
  s.horizon.resize(std::max<std::size_t>(s.horizon.size(), 64));
  s.visible[0] = seed;
  visited[seed] = 1;
  for (std::size_t k = 0; k < visible; ++k) {
    if (visible + d > s.visible.size()) s.visible.resize(2 * s.visible.size() + d);
    if (ridges + d > s.horizon.size()) s.horizon.resize(2 * s.horizon.size() + d);
    if (k % 4096 == 4095) run_.check();
    Id* const list = s.visible.data();
    HorizonRidge* const horizon = s.horizon.data();
    const Id f = list[k];
    const Id* n = store_.neighbours(f);
    // Which neighbours are visible is unpredictable, so no branch depends on it. A facet beyond the
    // horizon is tested once for each of its horizon ridges, which costs less than remembering it.
    for (unsigned first = 0; first < d; first += 32) {
      std::uint32_t all = seen_among(lane, y, n, first, s.next);
      for (unsigned j = first; j < std::min(d, first + 32); ++j, all >>= 1) {
        const Id other = n[j];
        const std::uint32_t seen = all & 1U, known = visited[other];
        visited[other] = static_cast<std::uint8_t>(known | seen);
        list[visible] = other;
        visible += seen & ~known;
        horizon[ridges] = {f, other, static_cast<std::uint8_t>(j), 0};
        ridges += 1 - seen;
      }
    }
    // Prefetch the facets that are `early` places from being processed.
    if (k + early < visible) {
      const Id* next = store_.neighbours(list[k + early]);
      for (unsigned j = 0; j < d; ++j) store_.prefetch(next[j]);
    }
  }
  s.visible.resize(visible);
  s.seen = visible;
  s.horizon.resize(ridges);
  for (const Id f : s.visible) visited[f] = 0;
  for (std::size_t k = 0; k < ridges; ++k) {
    if (k + ahead < ridges) prefetch_line(store_.neighbours(s.horizon[k + ahead].outside));
    HorizonRidge& r = s.horizon[k];
    r.back = static_cast<std::uint8_t>(index_of(store_.neighbours(r.outside), r.facet));
  }
}

/// Makes a new facet on every horizon ridge. New facets first reuse the slots of the visible ones,
/// so neighbours stay near in memory and hints stay valid.
template <unsigned D>
void InsertionNd<D>::replace(Stream& s, Lane& lane) {
  const unsigned d = dim();
  const std::size_t count = s.horizon.size();
  const Id point = s.next - 1;
  lane.vertices.resize(count * d);
  lane.neighbours.resize(count * d);
  lane.apex.resize(count);
  lane.planes.resize(count * (d + 1));
  for (std::size_t k = 0; k < count; ++k) {
    if (k + ahead < count) prefetch_line(store_.vertices(s.horizon[k + ahead].facet));
    const HorizonRidge& r = s.horizon[k];
    Id* v = lane.vertices.data() + k * d;
    std::memcpy(v, store_.vertices(r.facet), d * sizeof(Id));
    v[r.apex] = point;
    lane.apex[k] = r.apex;
    store_.neighbours(r.facet)[r.apex] = static_cast<Id>(k) | horizon_tag;
  }
  lane.pairs.find<D>(d, lane.vertices.data(), lane.apex.data(), count, lane.neighbours.data(),
                     [&](std::size_t k, unsigned i) { return turn(s, k, i); });
  run_.check();
  if constexpr (D == 0) {
    lane.wide.resize(count * (d + 1));
    for (std::size_t k = 0; k < count; ++k) {
      const HorizonRidge& r = s.horizon[k];
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
  const Id* const slot = s.visible.data();
  for (std::size_t k = count; k < s.seen; ++k) store_.vertices(slot[k])[0] = dead;
  for (std::size_t k = 0; k < count; ++k) {
    if (k + ahead < count) {
      store_.prefetch_to_write(slot[k + ahead]);
      prefetch_line_to_write(store_.neighbours(s.horizon[k + ahead].outside));
    }
    const HorizonRidge& r = s.horizon[k];
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
  s.hint = s.visible[0];
}

/// The new facet across the ridge of new facet k opposite to vertex i. Found by rotating, through
/// visible facets, about the face spanned by the horizon ridge of facet k without vertex i.
template <unsigned D>
typename InsertionNd<D>::Id InsertionNd<D>::turn(const Stream& s, std::size_t k, unsigned i) const {
  Id at = s.horizon[k].facet, kept_vertex = store_.vertices(at)[s.horizon[k].apex];
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

template <unsigned D>
Boundary InsertionNd<D>::collect() {
  const unsigned d = dim();
  claims_.release();
  // A facet's number: the count of live facets in earlier chunks, plus those before it in its own.
  constexpr unsigned chunk_bits = 14;
  constexpr std::uint64_t chunk = std::uint64_t{1} << chunk_bits;
  RawArray<Id> number;
  number.reserve(facet_slots_);
  const auto live =
      sum_chunks<Id>(facet_slots_, chunk, run_, [&](std::uint64_t begin, std::uint64_t end) {
        Id count = 0;
        for (std::uint64_t f = begin; f < end; ++f)
          number[f] = store_.alive(static_cast<Id>(f)) ? count++ : no_index;
        return count;
      });
  if constexpr (D == 0) {
    result_.doubtful.resize(live.total);
    run_.each_chunk(facet_slots_, chunk,
                    [&](std::uint64_t c, std::uint64_t begin, std::uint64_t end) {
      for (std::uint64_t f = begin; f < end; ++f)
        if (number[f] != no_index)
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
