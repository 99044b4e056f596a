// Boundaries for build_hull from the slow reference hull: shuffled, re-triangulated, oriented.
#pragma once

#include <algorithm>
#include <numeric>
#include <random>

#include "cullhull/certify.hpp"
#include "cullhull/hull.hpp"
#include "exact/orientation/orientation.hpp"
#include "exact/points/local_points.hpp"
#include "parallel/threads/run.hpp"
#include "result/build_hull.hpp"
#include "tests/reference/slow_hull.hpp"

namespace cullhull::reference {

/// The boundary that inserting the points in `order` leaves, in the engine's conventions and in a
/// random arrangement. Ids are those of the original rows.
inline internal::Boundary boundary_in_order(const std::vector<double>& rows, unsigned d,
                                            const std::vector<std::uint32_t>& order,
                                            std::mt19937& random) {
  std::vector<double> shuffled;
  for (const std::uint32_t i : order)
    shuffled.insert(shuffled.end(), rows.begin() + i * d, rows.begin() + (i + 1) * d);
  const SlowHull slow(shuffled, d);
  const auto& facets = slow.facets();
  std::vector<std::uint32_t> place(facets.size());  // new number of a facet
  std::iota(place.begin(), place.end(), 0U);
  std::shuffle(place.begin(), place.end(), random);
  std::vector<double> inside(d, 0);
  internal::Boundary out;
  out.dimension = d;
  out.vertices.resize(facets.size() * d);
  out.neighbours.resize(facets.size() * d);
  for (std::size_t f = 0; f < facets.size(); ++f) {
    std::vector<unsigned> slots(d);
    std::iota(slots.begin(), slots.end(), 0U);
    std::shuffle(slots.begin(), slots.end(), random);
    const auto sign = [&] {
      std::vector<const double*> p;
      for (const unsigned s : slots) p.push_back(slow.point(facets[f].vertices[s]));
      for (std::uint32_t i = 0;; ++i)
        if (facets[f].plane.side(slow.point(i)) < 0) {
          p.push_back(slow.point(i));
          return internal::orientation(d, p.data());
        }
    };
    if (sign() == internal::Sign::positive) std::swap(slots[0], slots[1]);
    for (unsigned j = 0; j < d; ++j) {
      out.vertices[place[f] * d + j] = order[facets[f].vertices[slots[j]]];
      out.neighbours[place[f] * d + j] = place[facets[f].neighbours[slots[j]]];
    }
  }
  // Which of equal points became the vertex depends on the order; the engine names the others.
  std::vector<std::uint32_t> used(out.vertices.begin(), out.vertices.end());
  std::sort(used.begin(), used.end());
  used.erase(std::unique(used.begin(), used.end()), used.end());
  for (std::uint32_t i = 0; i < order.size(); ++i)
    for (const std::uint32_t v : used)
      if (v != i && std::equal(&rows[i * d], &rows[i * d] + d, &rows[v * d]))
        out.duplicates.emplace_back(i, v);
  return out;
}

/// build_hull on full-dimensional rows.
inline Hull build(const std::vector<double>& rows, unsigned d, internal::Boundary boundary,
                  unsigned threads = 1) {
  const auto view = PointView::row_major(rows.data(), rows.size() / d, d);
  internal::LocalPoints local;
  local.dimension = d;
  local.count = static_cast<std::uint32_t>(view.count);
  local.coordinates = local.exact = rows.data();
  std::vector<unsigned> axes(d);
  std::iota(axes.begin(), axes.end(), 0U);
  const internal::Run& run = internal::short_run();
  Hull hull;
  internal::build_hull({&view, &local, nullptr, axes.data()}, std::move(boundary),
                       run.with_threads(threads), hull);
  return hull;
}

inline bool same_hull(const Hull& a, const Hull& b) {
  return a.vertices == b.vertices && a.facets.offsets == b.facets.offsets &&
         a.facets.items == b.facets.items &&
         a.facet_neighbours.offsets == b.facet_neighbours.offsets &&
         a.facet_neighbours.items == b.facet_neighbours.items && a.facet_planes == b.facet_planes &&
         a.simplices == b.simplices && a.simplex_neighbours == b.simplex_neighbours &&
         a.simplex_facets == b.simplex_facets && a.volume == b.volume && a.area == b.area &&
         a.centroid == b.centroid;
}

}  // namespace cullhull::reference
