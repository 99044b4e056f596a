// Small hulls, written down, for the tests of writers.
#pragma once

#include <cstdint>
#include <vector>

#include "cullhull/hull.hpp"

namespace cullhull::testing {

/// A hull of 3D points from its facets, counter-clockwise from outside, each from its lowest id, in
/// the order of their first simplex. `normals` with offset, one a facet.
inline Hull hull_from_polygons(const std::vector<std::vector<std::uint64_t>>& facets,
                               const std::vector<double>& planes, std::uint64_t point_count,
                               const std::vector<std::uint64_t>& vertices) {
  Hull h;
  h.dimension = 3;
  h.affine_dimension = 3;
  h.point_count = point_count;
  h.vertices = vertices;
  h.facet_planes.assign(planes.begin(), planes.end());
  for (std::uint32_t f = 0; f < facets.size(); ++f) {
    const auto& p = facets[f];
    Array<std::uint64_t>& corners = h.facets.items.edit();
    corners.insert(corners.end(), p.begin(), p.end());
    h.facets.offsets.push_back(h.facets.items.size());
    for (std::size_t j = 0; j < p.size(); ++j)
      for (std::uint32_t g = 0; g < facets.size(); ++g)
        for (std::size_t i = 0; i < facets[g].size(); ++i)
          if (facets[g][i] == p[(j + 1) % p.size()] &&
              facets[g][(i + 1) % facets[g].size()] == p[j])
            h.facet_neighbours.items.push_back(g);
    h.facet_neighbours.offsets.push_back(h.facet_neighbours.items.size());
    for (std::size_t j = 1; j + 1 < p.size(); ++j) {
      h.simplices.edit().insert(h.simplices.edit().end(), {p[0], p[j], p[j + 1]});
      h.simplex_facets.push_back(f);
      for (int i = 0; i < 3; ++i)
        h.simplex_neighbours.push_back(static_cast<std::uint32_t>(h.simplex_facets.size() - 1));
    }
  }
  return h;
}

struct Example {
  std::vector<double> coordinates;
  Hull hull;
  PointView view() const {
    return PointView::row_major(coordinates.data(), hull.point_count, hull.dimension);
  }
};

/// The unit cube, and its centre as point 0; corner 1 + (x + 2 y + 4 z).
inline Example cube() {
  Example e;
  e.coordinates = {0.5, 0.5, 0.5};
  for (int i = 0; i < 8; ++i)
    for (int j = 0; j < 3; ++j) e.coordinates.push_back((i >> j) & 1);
  e.hull = hull_from_polygons(
      {{1, 2, 6, 5}, {1, 3, 4, 2}, {1, 5, 7, 3}, {2, 4, 8, 6}, {3, 7, 8, 4}, {5, 6, 8, 7}},
      {0, -1, 0, 0, 0, 0, -1, 0, -1, 0, 0, 0, 1, 0, 0, -1, 0, 1, 0, -1, 0, 0, 1, -1}, 9,
      {1, 2, 3, 4, 5, 6, 7, 8});
  e.hull.volume = 1;
  e.hull.area = 6;
  e.hull.centroid = {0.5, 0.5, 0.5};
  return e;
}

/// A square of the plane with its centre as point 2.
inline Example square() {
  Example e;
  e.coordinates = {0, 0, 1, 0, 0.5, 0.5, 0, 1, 1, 1};
  Hull& h = e.hull;
  h.dimension = 2;
  h.affine_dimension = 2;
  h.point_count = 5;
  h.vertices = {0, 1, 4, 3};
  h.facets = {{0, 2, 4, 6, 8}, {0, 1, 3, 0, 1, 4, 4, 3}};
  h.facet_neighbours = {{0, 2, 4, 6, 8}, {2, 1, 0, 3, 3, 0, 1, 2}};
  h.facet_planes = {0, -1, 0, -1, 0, 0, 1, 0, -1, 0, 1, -1};
  h.simplices = h.facets.items;
  h.simplex_neighbours = h.facet_neighbours.items;
  h.simplex_facets = {0, 1, 2, 3};
  h.volume = 1;
  h.area = 4;
  h.centroid = {0.5, 0.5};
  return e;
}

}  // namespace cullhull::testing
