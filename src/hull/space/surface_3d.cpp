#include "hull/space/surface_3d.hpp"

#include <algorithm>
#include <cstring>

#include "cullhull/error.hpp"
#include "parallel/parallel.hpp"

namespace cullhull::internal {
namespace {

using Id = std::uint32_t;

}  // namespace

std::vector<Surface3D::Run> Surface3D::runs(std::uint32_t length) const {
  std::vector<Run> out;
  for (const auto& [begin, end] : used)
    for (std::uint64_t at = begin; at < end; at += length)
      out.emplace_back(static_cast<Id>(at),
                       static_cast<Id>(std::min<std::uint64_t>(end, at + length)));
  return out;
}

SimplicialHull to_simplicial(Surface3D&& surface, unsigned threads, const Control& control) {
  const auto runs = surface.runs(1 << 15);
  const Facet3D* facets = surface.facets.data();
  const auto each_run = [&](const auto& body) {
    for_each_chunk(runs.size(), 1, threads, [&](std::uint64_t c, std::uint64_t, std::uint64_t) {
      control.check();
      body(c, runs[c].first, runs[c].second);
    });
  };
  std::vector<Id> first(runs.size() + 1, 0);
  each_run([&](std::uint64_t c, Id begin, Id end) {
    Id count = 0;
    for (Id f = begin; f < end; ++f) count += static_cast<Id>(facets[f].live());
    first[c + 1] = count;
  });
  for (std::size_t c = 0; c < runs.size(); ++c) first[c + 1] += first[c];
  // Where every point is extreme no slot is free, and a facet's number is its slot.
  const Id slots = runs.empty() ? 0 : runs.back().second;
  const bool dense = first.back() == slots;
  BigArray<Id> number(dense ? 0 : slots);
  if (!dense)
    each_run([&](std::uint64_t c, Id begin, Id end) {
      Id count = first[c];
      for (Id f = begin; f < end; ++f) {
        number[f] = count;
        count += static_cast<Id>(facets[f].live());
      }
    });
  SimplicialHull hull;
  hull.dimension = 3;
  resize_big(hull.vertices, std::size_t{first.back()} * 3);
  resize_big(hull.neighbours, std::size_t{first.back()} * 3);
  each_run([&](std::uint64_t c, Id begin, Id end) {
    std::size_t at = std::size_t{first[c]} * 3;
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
  std::copy_n(surface.rung_counts, 3, hull.rung_counts);
  return hull;
}

Surface3D to_surface(const SimplicialHull& hull, const LocalPoints& points, unsigned threads,
                     const Control& control) {
  const auto fail = [](const char* what) {
    throw Error(ErrorCode::not_exact,
                std::string("the engine's boundary is not that of the exact hull: ") + what);
  };
  const std::size_t count = hull.facet_count();
  if (count < 4 || count >= Facet3D::none || hull.vertices.size() != count * 3 ||
      hull.neighbours.size() != hull.vertices.size())
    fail("too few facets");
  Surface3D s;
  s.count = points.count;
  s.live = count;
  s.used = {{0, static_cast<Id>(count)}};
  s.facets.reserve(count);
  s.order = BigArray<Id>(points.count);
  s.rows = BigArray<double>(std::size_t{points.count} * Shared3D::row_stride);
  constexpr std::uint64_t chunk = 1 << 15;
  for_each_chunk(points.count, chunk, threads,
                 [&](std::uint64_t, std::uint64_t begin, std::uint64_t end) {
                   control.check();
                   for (std::uint64_t i = begin; i < end; ++i) {
                     s.order[i] = static_cast<Id>(i);
                     double* row = s.rows.get() + i * Shared3D::row_stride;
                     std::memcpy(row, points.row(static_cast<Id>(i)), 3 * sizeof(double));
                     row[3] = 0;
                   }
                 });
  for_each_chunk(count, chunk, threads, [&](std::uint64_t, std::uint64_t begin, std::uint64_t end) {
    control.check();
    for (std::uint64_t f = begin; f < end; ++f) {
      Facet3D& facet = s.facets[f];
      for (unsigned j = 0; j < 3; ++j) {
        facet.vertices[j] = hull.vertices[f * 3 + j];
        facet.neighbours[j] = hull.neighbours[f * 3 + j];
        if (facet.vertices[j] >= points.count) fail("an id is out of range");
        if (facet.neighbours[j] >= count) fail("a ridge has no second facet");
      }
      facet.owner = 0;
    }
  });
  s.duplicates = hull.duplicates;
  const Id any[4] = {0, 0, 0, 0};  // no cones are asked for
  s.predicates.emplace(points, any);
  return s;
}

}  // namespace cullhull::internal
