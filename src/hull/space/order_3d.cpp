#include "hull/space/order_3d.hpp"

#include <algorithm>
#include <array>
#include <bit>

#include "geometry/insertion_rounds.hpp"
#include "parallel/random_stream.hpp"
#include "parallel/scan.hpp"
#include "parallel/threads/parallel.hpp"

namespace cullhull::internal {
namespace {

/// A round has 15 times as many points as all rounds before it (measured: 7 to 31 take the same
/// time).
constexpr unsigned round_bits = 4;
constexpr std::uint32_t first_round = 64;

constexpr std::uint64_t sort_chunk = 1 << 12;

/// Sorts the points of crowded cells by finer keys: points along curves crowd into few cells, and
/// walks through a cell's unordered points are long. `keyed` is sorted from `first` on; cells of
/// more than `longest` points (near-copies, which no order helps) stay unchanged. Saves 167 of 1015
/// ms on two circles (200,000 points).
void refine_cells(const LocalPoints& points, const DirectionKey& key, KeyedId* keyed,
                  std::uint32_t first, std::uint32_t n, const Run& run) {
  constexpr std::uint64_t chunk_size = 1 << 14, longest = 1 << 17;
  // Crowded: a quarter of the points share a cell with 4 others. With fewer than 2^16 points walks
  // stay in the cache, and reordering costs more than it saves.
  constexpr std::uint32_t crowd = 4, fewest = 1U << 16;
  if (n < first + fewest) return;
  const std::uint64_t count = n - first;
  const KeyedId* const begin_all = keyed + first;
  const auto crowded = [&](std::uint64_t begin, std::uint64_t end) {
    std::uint64_t sum = 0;
    for (std::uint64_t i = std::max<std::uint64_t>(begin, crowd); i < end; ++i)
      sum += begin_all[i].key == begin_all[i - crowd].key;
    return sum;
  };
  if (sum_chunks<std::uint64_t>(count, chunk_size, run, crowded).total < count / 4) return;

  struct Fine {
    std::uint64_t key;
    std::uint32_t id;
    bool operator<(const Fine& o) const { return key < o.key || (key == o.key && id < o.id); }
  };
  // The beginning of the first cell at or after place i.
  const auto cell_begin = [&](std::uint64_t i) {
    while (i > 0 && i < count && begin_all[i].key == begin_all[i - 1].key) ++i;
    return i;
  };
  run.each(count, chunk_size, [&](std::uint64_t begin, std::uint64_t end) {
    constexpr std::uint32_t block = DirectionKey::block;
    double x[block] = {}, y[block] = {}, z[block] = {};
    std::uint64_t keys[block];
    const std::uint64_t from = cell_begin(begin), last = cell_begin(end);
    std::vector<Fine> fine(last - std::min(from, last));
    for (std::uint64_t at = 0; at < fine.size(); at += block) {
      const auto some =
          static_cast<std::uint32_t>(std::min<std::uint64_t>(block, fine.size() - at));
      for (std::uint32_t i = 0; i < some; ++i) {
        const double* p = points.row(begin_all[from + at + i].id);
        x[i] = p[0];
        y[i] = p[1];
        z[i] = p[2];
      }
      key.fine_keys(x, y, z, keys);
      for (std::uint32_t i = 0; i < some; ++i)
        fine[at + i] = {keys[i], begin_all[from + at + i].id};
    }
    for (std::uint64_t at = from; at < last;) {
      std::uint64_t cell_end = at + 1;
      while (cell_end < count && begin_all[cell_end].key == begin_all[at].key) ++cell_end;
      if (cell_end - at > 1 && cell_end - at <= longest) {
        std::sort(fine.data() + (at - from), fine.data() + (cell_end - from));
        for (std::uint64_t i = at; i < cell_end; ++i) keyed[first + i].id = fine[i - from].id;
      }
      at = cell_end;
    }
  });
}

}  // namespace

InsertionOrder3D insertion_order_3d(const LocalPoints& points, const DirectionKey& key,
                                    const std::uint32_t* simplex, const Run& run) {
  const std::uint32_t n = points.count;
  InsertionOrder3D order;
  const InsertionRounds random_rounds(n, first_round, round_bits);
  const unsigned rounds = random_rounds.count;
  // About as many cells as points.
  order.key_bits = std::clamp((static_cast<unsigned>(std::bit_width(n)) + 1) / 2, 2U, 12U);
  const unsigned key_width = 2 * order.key_bits + 3;
  const auto width = key_width + static_cast<unsigned>(std::bit_width(rounds));
  BigArray<KeyedId> memory(2 * std::size_t{n});
  KeyedId *keyed = memory.get(), *scratch = memory.get() + n;
  std::vector<std::array<std::uint32_t, 16>> sizes(chunk_count(n, sort_chunk));
  run.each_chunk(n, sort_chunk, [&](std::uint64_t c, std::uint64_t begin, std::uint64_t end) {
    constexpr std::uint32_t block = DirectionKey::block;
    double x[block] = {}, y[block] = {}, z[block] = {};
    std::uint32_t keys[block];
    std::array<std::uint32_t, 16> count{};
    for (std::uint64_t at = begin; at < end; at += block) {
      const auto size = static_cast<std::uint32_t>(std::min<std::uint64_t>(block, end - at));
      for (std::uint32_t i = 0; i < size; ++i) {
        const double* p = points.row(static_cast<std::uint32_t>(at + i));
        x[i] = p[0];
        y[i] = p[1];
        z[i] = p[2];
      }
      key.keys(x, y, z, order.key_bits, keys);
      for (std::uint32_t i = 0; i < size; ++i) {
        const auto id = static_cast<std::uint32_t>(at + i);
        unsigned r = 1 + random_rounds.round_of(mix64(id + 0x9E3779B97F4A7C15ULL));  // 0: simplex
        if (id == simplex[0] || id == simplex[1] || id == simplex[2] || id == simplex[3]) r = 0;
        keyed[id] = {(r << key_width) | (r > 1 ? keys[i] : 0), id};
        ++count[r];
      }
    }
    sizes[c] = count;
  });
  radix_sort(keyed, scratch, n, width, run);
  std::uint32_t unsorted = 0;  // the first rounds
  for (const auto& count : sizes) unsorted += count[0] + count[1];
  refine_cells(points, key, keyed, unsorted, n, run);
  order.ids = BigArray<std::uint32_t>(n);
  run.each(n, sort_chunk, [&](std::uint64_t begin, std::uint64_t end) {
    for (std::uint64_t i = begin; i < end; ++i) order.ids[i] = keyed[i].id;
  });
  std::uint32_t sum = 0;
  for (unsigned r = 0; r <= rounds; ++r) {
    for (const auto& count : sizes) sum += count[r];
    if (order.round_ends.empty() || sum > order.round_ends.back()) order.round_ends.push_back(sum);
  }
  return order;
}

}  // namespace cullhull::internal
