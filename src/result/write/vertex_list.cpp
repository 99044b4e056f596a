#include "result/write/vertex_list.hpp"

#include <algorithm>
#include <atomic>
#include <cstring>

#include "result/write/ranking.hpp"

namespace cullhull::internal::inline result {

VertexList list_vertices(const Boundary& surface, std::uint32_t points, const std::uint64_t* ids,
                         const Run& run) {
  BigArray<std::uint8_t> used(points);
  std::memset(used.get(), 0, points);
  const bool many = surface.dimension > 3;
  run.each(surface.vertices.size(), light_grain, [&](std::uint64_t begin, std::uint64_t end) {
    for (std::uint64_t i = begin; i < end; ++i) {
      // Threads may set the same flag, to the same value. Where a vertex has dozens of facets, most
      // find it set, and avoid taking the cache line from one another.
      const std::atomic_ref<std::uint8_t> flag(used[surface.vertices[i]]);
      if (many && flag.load(std::memory_order_relaxed) != 0) continue;
      flag.store(1, std::memory_order_relaxed);
    }
  });
  VertexList list;
  const auto prepare = [&](std::uint32_t vertices) {
    list.all_points = vertices == points;
    list.plain = list.all_points && ids == nullptr;
    resize_big(list.ids, vertices);
    if (!list.all_points) list.positions = BigArray<std::uint32_t>(points);
    return true;
  };
  rank_flagged(used.get(), points, run, prepare, [&](std::uint64_t p, std::uint32_t rank) {
    if (!used[p]) return;
    list.ids[rank] = ids != nullptr ? ids[p] : p;
    if (!list.all_points) list.positions[p] = rank;
  });
  return list;
}

}  // namespace cullhull::internal::inline result
