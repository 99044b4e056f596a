#include "result/extreme_rows.hpp"

#include <algorithm>
#include <atomic>
#include <cstring>

#include "parallel/big_array.hpp"
#include "parallel/parallel.hpp"
#include "result/merge.hpp"
#include "result/vertex_list.hpp"

namespace cullhull::internal {

std::vector<std::uint64_t> extreme_rows(SimplicialHull&& boundary, const LocalPoints& points,
                                        unsigned threads, const Control& control,
                                        std::uint64_t* rung_counts) {
  Surface surface = make_surface(std::move(boundary), points, threads);
  const auto pairs = coplanar_pairs(surface, points, threads, control, rung_counts);
  if (!pairs.empty())
    surface = merge_coplanar(std::move(surface), pairs, points, threads, control).surface;
  return std::move(list_vertices(surface, points.count, nullptr, threads).ids);
}

std::vector<std::uint64_t> ascending_ids(const std::uint32_t* corners, std::size_t size,
                                         std::uint32_t count, const std::uint64_t* ids,
                                         unsigned threads, const Control& control) {
  std::vector<std::uint64_t> out;
  if (size < count / 64) {
    out.assign(corners, corners + size);
    std::sort(out.begin(), out.end());
    if (ids != nullptr)
      for (std::uint64_t& v : out) v = ids[v];
    return out;
  }
  constexpr std::uint64_t chunk = std::uint64_t{1} << 15;
  BigArray<std::uint8_t> used(count);
  std::memset(used.get(), 0, count);
  // Meanwhile one thread makes room, which takes as long: a vector clears it.
  for_each_chunk(chunk_count(size, chunk) + 1, 1, threads,
                 [&](std::uint64_t job, std::uint64_t, std::uint64_t) {
                   control.check();
                   if (job == 0) return resize_big(out, size);
                   // No two corners are equal; neighbouring bytes may be written at once.
                   const std::uint64_t end = std::min<std::uint64_t>(size, job * chunk);
                   for (std::uint64_t i = (job - 1) * chunk; i < end; ++i) used[corners[i]] = 1;
                 });
  std::vector<std::uint64_t> start(chunk_count(count, chunk) + 1, 0);
  for_each_chunk(count, chunk, threads,
                 [&](std::uint64_t c, std::uint64_t begin, std::uint64_t end) {
                   control.check();
                   std::uint64_t sum = 0;
                   for (std::uint64_t p = begin; p < end; ++p) sum += used[p];
                   start[c + 1] = sum;
                 });
  for (std::size_t c = 1; c < start.size(); ++c) start[c] += start[c - 1];
  for_each_chunk(count, chunk, threads,
                 [&](std::uint64_t c, std::uint64_t begin, std::uint64_t end) {
                   control.check();
                   std::uint64_t next = start[c];
                   for (std::uint64_t p = begin; p < end; ++p)
                     if (used[p]) out[next++] = ids != nullptr ? ids[p] : p;
                 });
  return out;
}

}  // namespace cullhull::internal
