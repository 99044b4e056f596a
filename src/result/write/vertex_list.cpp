#include <algorithm>
#include <atomic>
#include <cstring>

#include "parallel/memory/raw_array.hpp"
#include "parallel/scan.hpp"
#include "result/boundary.hpp"
#include "result/write/write_simplices.hpp"

namespace cullhull::internal {

VertexList list_vertices(const Boundary& surface, std::uint32_t points, const std::uint64_t* ids,
                         const Run& run) {
  constexpr std::uint64_t grain = std::uint64_t{1} << 13;
  BigArray<std::uint8_t> used(points);
  std::memset(used.get(), 0, points);
  const bool many = surface.dimension > 3;
  run.each(surface.vertices.size(), grain, [&](std::uint64_t begin, std::uint64_t end) {
    for (std::uint64_t i = begin; i < end; ++i) {
      // Threads may set the same flag, to the same value. If a vertex has dozens of facets, the
      // flag is usually set already. Testing it first avoids taking the cache line from other
      // threads.
      const std::atomic_ref<std::uint8_t> flag(used[surface.vertices[i]]);
      if (many && flag.load(std::memory_order_relaxed) != 0) continue;
      flag.store(1, std::memory_order_relaxed);
    }
  });
  VertexList list;
  const auto prepare = [&](std::uint64_t vertices) {
    list.all_points = vertices == points;
    list.plain = list.all_points && ids == nullptr;
    resize_big(list.ids, vertices);
    if (!list.all_points) list.positions = BigArray<std::uint32_t>(points);
    return true;
  };
  pack(
      points, grain, run, [&](std::uint64_t p) { return used[p] != 0; }, prepare,
      [&](std::uint64_t p, std::uint64_t rank) {
    list.ids[rank] = ids != nullptr ? ids[p] : p;
    if (!list.all_points) list.positions[p] = static_cast<std::uint32_t>(rank);
      });
  return list;
}

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
  // Meanwhile one thread resizes the result: std::vector clears its memory, which takes as long.
  run.each_item(chunk_count(size, light_grain) + 1, [&](std::uint64_t job) {
    if (job == 0) return resize_big(out, size);
    // All corners differ, so each byte is written once. Neighbouring bytes may be written
    // concurrently.
    const std::uint64_t end = std::min<std::uint64_t>(size, job * light_grain);
    for (std::uint64_t i = (job - 1) * light_grain; i < end; ++i) used[corners[i]] = 1;
  });
  pack(
      count, light_grain, run, [&](std::uint64_t p) { return used[p] != 0; },
      [](std::uint64_t) { return true; },
      [&](std::uint64_t p, std::uint64_t rank) { out[rank] = ids != nullptr ? ids[p] : p; });
  return out;
}

}  // namespace cullhull::internal
