#include "result/vertex_list.hpp"

#include <algorithm>
#include <atomic>
#include <cstring>

#include "parallel/parallel.hpp"

namespace cullhull::internal {

VertexList list_vertices(const Surface& surface, std::uint32_t points, const std::uint64_t* ids,
                         unsigned threads) {
  constexpr std::uint64_t chunk = std::uint64_t{1} << 15;
  BigArray<std::uint8_t> used(points);
  std::memset(used.get(), 0, points);
  const bool many = surface.k > 3;
  for_each_chunk(surface.ids.size(), chunk, threads,
                 [&](std::uint64_t, std::uint64_t begin, std::uint64_t end) {
                   for (std::uint64_t i = begin; i < end; ++i) {
                     // Threads may set the same flag, to the same value. Where a vertex has dozens
                     // of facets, most find it set, and need not take the line from one another.
                     const std::atomic_ref<std::uint8_t> flag(used[surface.ids[i]]);
                     if (many && flag.load(std::memory_order_relaxed) != 0) continue;
                     flag.store(1, std::memory_order_relaxed);
                   }
                 });
  std::vector<std::uint32_t> start(chunk_count(points, chunk) + 1, 0);
  for_each_chunk(points, chunk, threads,
                 [&](std::uint64_t c, std::uint64_t begin, std::uint64_t end) {
                   std::uint32_t count = 0;
                   for (std::uint64_t p = begin; p < end; ++p) count += used[p];
                   start[c + 1] = count;
                 });
  for (std::size_t c = 1; c < start.size(); ++c) start[c] += start[c - 1];
  VertexList list;
  list.all_points = start.back() == points;
  list.plain = list.all_points && ids == nullptr;
  resize_big(list.ids, start.back());
  if (!list.all_points) list.positions = BigArray<std::uint32_t>(points);
  for_each_chunk(points, chunk, threads,
                 [&](std::uint64_t c, std::uint64_t begin, std::uint64_t end) {
                   std::uint32_t next = start[c];
                   for (std::uint64_t p = begin; p < end; ++p) {
                     if (!used[p]) continue;
                     list.ids[next] = ids != nullptr ? ids[p] : p;
                     if (!list.all_points) list.positions[p] = next;
                     ++next;
                   }
                 });
  return list;
}

}  // namespace cullhull::internal
