// The 3D engine's second insertion order, for bodies whose facets are slivers.
#include <algorithm>
#include <bit>

#include "hull/space/engine_3d.hpp"
#include "parallel/radix_sort.hpp"

namespace cullhull::internal {

/// Ranks the facets by their normals, along a curve.
void Engine3D::rank_facets() {
  struct Ranked {
    std::uint64_t key;
    Id facet;
  };
  const auto runs = used_slots(1 << 13);
  rank_ = BigArray<Id>(slots_);
  const auto live = sum_chunks<Id>(runs.size(), 1, run_, [&](std::uint64_t c, std::uint64_t) {
    Id count = 0;
    for (Id f = runs[c].first; f < runs[c].second; ++f) count += static_cast<Id>(facets_[f].live());
    return count;
  });
  BigArray<Ranked> order(2 * std::size_t{live.total});
  run_.each_item(runs.size(), [&](std::uint64_t c) {
    Id at = live.before[c];
    for (Id f = runs[c].first; f < runs[c].second; ++f)
      if (facets_[f].live()) order[at++] = {0, f};
  });
  run_.each(live.total, 1 << 13, [&](std::uint64_t first, std::uint64_t last) {
    constexpr std::uint32_t block = DirectionKey::block;
    double normals[3][block] = {};
    std::uint64_t keys[block];
    for (std::uint64_t at = first; at < last; at += block) {
      const auto size = static_cast<Id>(std::min<std::uint64_t>(block, last - at));
      for (Id i = 0; i < size; ++i)
        for (unsigned j = 0; j < 3; ++j) normals[j][i] = facets_[order[at + i].facet].normal[j];
      normal_key_.fine_keys(normals[0], normals[1], normals[2], keys);
      for (Id i = 0; i < size; ++i) order[at + i].key = keys[i];
    }
  });
  Ranked *ranked = order.get(), *scratch = ranked + live.total;
  radix_sort(ranked, scratch, live.total, DirectionKey::fine_bits, run_,
             [](const Ranked& r) { return r.key; });
  run_.each(live.total, light_grain, [&](std::uint64_t first, std::uint64_t last) {
    for (std::uint64_t k = first; k < last; ++k) rank_[ranked[k].facet] = static_cast<Id>(k);
  });
}

/// The relative position of a point on facet f between the neighbours of lowest and of highest
/// rank, in [0, 1).
double Engine3D::way_across(Id f, const double* p) const {
  const Facet3D& facet = facets_[f];
  Id low = facet.neighbours[0], high = low;
  for (const Id n : facet.neighbours) {
    if (rank_[n] < rank_[low]) low = n;
    if (rank_[n] > rank_[high]) high = n;
  }
  double axis[3], least = 0, most = 0, at = 0;
  for (unsigned j = 0; j < 3; ++j) axis[j] = facets_[high].normal[j] - facets_[low].normal[j];
  const double* base = shared_.row(facet.vertices[0]);
  for (unsigned k = 0; k < 4; ++k) {
    const double* x = k < 3 ? shared_.row(facet.vertices[k]) : p;
    at = 0;
    for (unsigned j = 0; j < 3; ++j) at += axis[j] * (x[j] - base[j]);
    if (k == 3) break;
    least = std::min(least, at);
    most = std::max(most, at);
  }
  const double way = (at - least) / (most - least);
  return way > 0 ? std::min(way, 0.999) : 0;  // also for 0 / 0
}

/// Sorts the points of the coming rounds by the normal of the facet they are above or beneath.
/// Where facets are slivers, along the rulings of a cone say, facets are neighbours exactly if
/// their normals are close, and normals lie along a curve.
void Engine3D::sort_by_normals(std::size_t round) {
  const Id begin = order_.round_ends[round], n = points_.count;
  rank_facets();
  const auto rank_bits = static_cast<unsigned>(std::bit_width(slots_));
  const unsigned way_bits = std::min(8U, 32 - rank_bits);
  BigArray<KeyedId> memory(2 * std::size_t{n - begin});
  KeyedId *keyed = memory.get(), *scratch = memory.get() + (n - begin);
  const Id start = live_facet();
  run_.each(n - begin, 1 << 14, [&](std::uint64_t first, std::uint64_t last) {
    Id f = start;
    for (std::uint64_t i = first; i < last; ++i) {
      const auto position = static_cast<Id>(begin + i);
      const double* p = shared_.row(position);
      f = climb(shared_, f, f, p);
      const double way = way_across(f, p);
      keyed[i] = {(rank_[f] << way_bits) | static_cast<Id>(way * (1U << way_bits)), position};
    }
  });
  const auto& ends = order_.round_ends;
  for (std::size_t r = round; r + 1 < ends.size(); ++r) {
    const Id offset = ends[r] - begin;
    KeyedId *items = keyed + offset, *other = scratch + offset;
    radix_sort(items, other, ends[r + 1] - ends[r], rank_bits + way_bits, run_);
    if (items == keyed + offset) continue;
    run_.each(ends[r + 1] - ends[r], light_grain, [&](std::uint64_t first, std::uint64_t last) {
      std::copy(items + first, items + last, keyed + offset + first);
    });
  }
  if (!shorter_walks(begin, ends[round + 1], keyed)) {
    by_normals_ = false;
    normals_help_ = false;
    return;
  }
  permute(begin, keyed);
}

/// Whether walks take fewer steps in `order` than in the present order, on parts of the round's
/// points. Where normals are noise, as on a rotated plane, ordering by them scatters points that
/// were in order.
bool Engine3D::shorter_walks(Id begin, Id end, const KeyedId* order) const {
  // 16 times 32 walks for each order suffice: where orders differ at all, the numbers of steps
  // differ severalfold.
  constexpr Id stretches = 16, length = 32;
  if (end - begin < stretches * length) return false;
  std::uint64_t steps[2 * stretches];
  const Id start = live_facet();
  run_.each_item(2 * stretches, [&](std::uint64_t k) {
    Piece3D reader;
    reader.owner_count = none;  // all
    reader.hint = start;
    const auto first = static_cast<Id>(std::uint64_t{end - begin - length} * (k / 2) / stretches);
    Id positions[length];
    for (Id i = 0; i < length; ++i)
      positions[i] = k % 2 == 0 ? begin + first + i : order[first + i].id;
    screen_points(shared_, reader, positions, 0, 1);  // this walk starts far away: not counted
    const std::uint64_t before = reader.steps;
    screen_points(shared_, reader, positions, 1, length);
    steps[k] = reader.steps - before;
  });
  std::uint64_t sums[2] = {0, 0};
  for (Id k = 0; k < 2 * stretches; ++k) sums[k % 2] += steps[k];
  return sums[1] < sums[0];
}

/// Permutes the points from position `begin` on into the given order of positions.
void Engine3D::permute(Id begin, const KeyedId* order) {
  const Id n = points_.count;
  BigArray<Id> ids(n);
  BigArray<double> rows(std::size_t{n} * Shared3D::row_stride);
  run_.each(n, 1 << 14, [&](std::uint64_t first, std::uint64_t last) {
    for (std::uint64_t i = first; i < last; ++i) {
      const Id from = i < begin ? static_cast<Id>(i) : order[i - begin].id;
      ids[i] = order_.ids[from];
      std::copy_n(shared_.row(from), Shared3D::row_stride, rows.get() + i * Shared3D::row_stride);
    }
  });
  order_.ids = std::move(ids);
  rows_ = std::move(rows);
  shared_.order = order_.ids.get();
  shared_.rows = rows_.get();
}

}  // namespace cullhull::internal
