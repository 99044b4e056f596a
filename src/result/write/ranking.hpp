// Ranks of flagged items.
#pragma once

#include <cstddef>
#include <cstdint>
#include <numeric>
#include <vector>

#include "parallel/threads/run.hpp"

namespace cullhull::internal::inline result {

/// `flags`: 0 or 1 for each of `count` items. Calls prepare(total) with the number of ones, then,
/// if that returns true, visit(item, rank) for every item, `rank` being the number of flagged items
/// before it. Two passes over the flags, in parallel chunks.
template <class Prepare, class Visit>
void rank_flagged(const std::uint8_t* flags, std::uint64_t count, const Run& run,
                  const Prepare& prepare, const Visit& visit) {
  std::vector<std::uint32_t> start(chunk_count(count, light_grain) + 1, 0);
  run.each_chunk(count, light_grain, [&](std::uint64_t c, std::uint64_t begin, std::uint64_t end) {
    start[c + 1] = std::accumulate(flags + begin, flags + end, std::uint32_t{0});
  });
  for (std::size_t c = 1; c < start.size(); ++c) start[c] += start[c - 1];
  if (!prepare(start.back())) return;
  run.each_chunk(count, light_grain, [&](std::uint64_t c, std::uint64_t begin, std::uint64_t end) {
    std::uint32_t rank = start[c];
    for (std::uint64_t i = begin; i < end; ++i) {
      visit(i, rank);
      rank += flags[i];
    }
  });
}

}  // namespace cullhull::internal::inline result
