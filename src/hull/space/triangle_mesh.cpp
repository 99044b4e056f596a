#include "hull/space/triangle_mesh.hpp"

#include <algorithm>

#include "parallel/scan.hpp"

namespace cullhull::internal {

std::vector<TriangleMesh::Run> TriangleMesh::runs(std::uint32_t length) const {
  std::vector<Run> out;
  for (const auto& [begin, end] : used)
    for (std::uint64_t at = begin; at < end; at += length)
      out.emplace_back(static_cast<std::uint32_t>(at),
                       static_cast<std::uint32_t>(std::min<std::uint64_t>(end, at + length)));
  return out;
}

Boundary boundary_of(TriangleMesh&& surface, const Run& run) {
  using Id = std::uint32_t;
  const auto runs = surface.runs(1 << 15);
  const Facet3D* facets = surface.facets.data();
  const auto each_run = [&](const auto& body) {
    run.each_item(runs.size(), [&](std::uint64_t c) { body(c, runs[c].first, runs[c].second); });
  };
  const auto live = sum_chunks<Id>(runs.size(), 1, run, [&](std::uint64_t c, std::uint64_t) {
    Id count = 0;
    for (Id f = runs[c].first; f < runs[c].second; ++f) count += static_cast<Id>(facets[f].live());
    return count;
  });
  // Where every point is extreme no slot is unused, and a facet's number is its slot.
  const Id slots = runs.empty() ? 0 : runs.back().second;
  const bool dense = live.total == slots;
  BigArray<Id> number(dense ? 0 : slots);
  if (!dense)
    each_run([&](std::uint64_t c, Id begin, Id end) {
      Id count = live.before[c];
      for (Id f = begin; f < end; ++f) {
        number[f] = count;
        count += static_cast<Id>(facets[f].live());
      }
    });
  Boundary hull;
  hull.dimension = 3;
  resize_big(hull.vertices, std::size_t{live.total} * 3);
  resize_big(hull.neighbours, std::size_t{live.total} * 3);
  each_run([&](std::uint64_t c, Id begin, Id end) {
    std::size_t at = std::size_t{live.before[c]} * 3;
    for (Id f = begin; f < end; ++f) {
      const Facet3D& facet = facets[f];
      if (!facet.live()) continue;
      for (unsigned j = 0; j < 3; ++j, ++at) {
        const Id n = facet.neighbours[j];
        hull.vertices[at] = surface.order[facet.vertices[j]];
        hull.neighbours[at] = dense ? n : number[n];
      }
    }
  });
  hull.duplicates = std::move(surface.duplicates);
  hull.rung_counts = surface.rung_counts;
  return hull;
}

}  // namespace cullhull::internal
