#include "result/write/extreme_rows.hpp"

#include <algorithm>
#include <atomic>
#include <cstring>

#include "parallel/memory/big_array.hpp"
#include "result/merge.hpp"
#include "result/write/ranking.hpp"
#include "result/write/vertex_list.hpp"

namespace cullhull::internal::inline result {

std::vector<std::uint64_t> extreme_rows(Boundary&& surface, const LocalPoints& points,
                                        const Run& run, std::uint64_t* rung_counts) {
  sort_simplices(surface, points, run);
  const auto pairs = coplanar_pairs(surface, points, run, rung_counts);
  if (!pairs.empty()) surface = merge_coplanar(std::move(surface), pairs, points, run).surface;
  return std::move(list_vertices(surface, points.count, nullptr, run).ids);
}

std::vector<std::uint64_t> ascending_ids(const std::uint32_t* corners, std::size_t size,
                                         std::uint32_t count, const std::uint64_t* ids,
                                         const Run& run) {
  std::vector<std::uint64_t> out;
  if (size < count / 64) {
    out.assign(corners, corners + size);
    std::sort(out.begin(), out.end());
    if (ids != nullptr)
      for (std::uint64_t& v : out) v = ids[v];
    return out;
  }
  BigArray<std::uint8_t> used(count);
  std::memset(used.get(), 0, count);
  // Meanwhile one thread resizes the result, which takes as long, as a vector clears its memory.
  run.each_item(chunk_count(size, light_grain) + 1, [&](std::uint64_t job) {
    if (job == 0) return resize_big(out, size);
    // No two corners are equal, and neighbouring bytes may be written concurrently.
    const std::uint64_t end = std::min<std::uint64_t>(size, job * light_grain);
    for (std::uint64_t i = (job - 1) * light_grain; i < end; ++i) used[corners[i]] = 1;
  });
  rank_flagged(
      used.get(), count, run, [](std::uint32_t) { return true; },
      [&](std::uint64_t p, std::uint32_t rank) {
    if (used[p]) out[rank] = ids != nullptr ? ids[p] : p;
      });
  return out;
}

}  // namespace cullhull::internal::inline result
