// Where the lists of a hull of few points go: into a Hull, or behind those of a HullBatch. Who
// finds such a hull writes it once, for both.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <utility>

#include "cullhull/batch.hpp"
#include "cullhull/hull.hpp"
#include "result/build_hull.hpp"

namespace cullhull::internal {

/// The sizes of a full-dimensional hull's lists.
struct FewSizes {
  unsigned dimension;
  std::size_t vertices, simplices, facets;
  std::size_t corners;  ///< of all facets together

  bool simplicial() const { return facets == simplices; }
};

/// The lists, to be written by whoever knows the hull, in the order of a Hull. The 64 bytes behind
/// each list but `vertices` may be overwritten, so that whole vectors can be stored.
struct FewLists {
  std::uint64_t *vertices, *simplices;
  std::uint64_t* facets;  ///< nullptr: shared with `simplices`
  std::uint32_t *simplex_neighbours, *facet_neighbours;
  std::uint32_t* simplex_facets;  ///< nullptr: facet i is simplex i
};

template <class T>
inline constexpr std::size_t few_lists_room = 64 / sizeof(T);

/// Appends `count` items and room for a vector behind them, which trim() removes.
template <class T>
T* extend(Array<T>& items, std::size_t count) {
  items.resize(items.size() + count + few_lists_room<T>);
  return items.data() + items.size() - count - few_lists_room<T>;
}
template <class T>
void trim(Array<T>& items) {
  items.resize(items.size() - few_lists_room<T>);
}

/// Fills the lists of `hull`. `corners_of(i)`: the number of corners of facet i, asked only where
/// some facet is no simplex. write(lists): writes them.
template <class CornersOf, class Write>
void write_lists(const FewSizes& s, Hull& hull, const CornersOf& corners_of, const Write& write) {
  using Ids = SharedArray<std::uint64_t>;
  const bool shared = s.simplicial() && facets_are_simplices(s.dimension);
  Array<std::uint64_t> simplices, facets;
  Array<std::uint32_t> neighbours, across, numbers;
  hull.vertices.resize(s.vertices);
  const std::size_t size = s.simplices * s.dimension;
  write(FewLists{hull.vertices.data(), extend(simplices, size),
                 shared ? nullptr : extend(facets, s.corners), extend(neighbours, size),
                 extend(across, s.corners),
                 s.simplicial() ? nullptr : extend(numbers, s.simplices)});
  trim(simplices), trim(neighbours), trim(across);
  if (!shared) trim(facets);
  hull.simplices = Ids(std::move(simplices));
  hull.simplex_neighbours = std::move(neighbours);
  hull.facets.items = shared ? hull.simplices : Ids(std::move(facets));
  hull.facet_neighbours.items = std::move(across);
  if (s.simplicial()) {
    hull.facets.offsets = EvenArray<std::uint64_t>::of_step(s.facets + 1, s.dimension);
    hull.simplex_facets = EvenArray<std::uint32_t>::of_step(s.simplices, 1);
  } else {
    trim(numbers);
    EvenArray<std::uint64_t> offsets{0};
    std::uint64_t at = 0;
    for (std::size_t i = 0; i < s.facets; ++i) offsets.push_back(at += corners_of(i));
    hull.facets.offsets = std::move(offsets);
    hull.simplex_facets = std::move(numbers);
  }
  hull.facet_neighbours.offsets = hull.facets.offsets;
}

/// The same behind the lists of a batch.
template <class CornersOf, class Write>
void write_lists(const FewSizes& s, HullBatch& to, const CornersOf& corners_of,
                 const Write& write) {
  to.vertices.items.resize(to.vertices.items.size() + s.vertices);
  const std::size_t size = s.simplices * s.dimension;
  const FewLists lists{to.vertices.items.data() + to.vertices.items.size() - s.vertices,
                       extend(to.simplices.items, size),
                       extend(to.facets.items, s.corners),
                       extend(to.simplex_neighbours.items, size),
                       extend(to.facet_neighbours.items, s.corners),
                       extend(to.simplex_facets.items, s.simplices)};
  write(lists);
  if (s.simplicial())
    for (std::size_t i = 0; i < s.simplices; ++i)
      lists.simplex_facets[i] = static_cast<std::uint32_t>(i);
  const auto end = [](auto& lists_of_sets) {
    lists_of_sets.offsets.push_back(lists_of_sets.items.size());
  };
  trim(to.simplices.items), trim(to.simplex_neighbours.items), trim(to.simplex_facets.items);
  trim(to.facets.items), trim(to.facet_neighbours.items);
  end(to.vertices), end(to.simplices), end(to.simplex_neighbours), end(to.simplex_facets);
  to.facet_starts.push_back(to.facet_starts.back() + s.facets);
  for (EvenArray<std::uint64_t>* offsets : {&to.facets.offsets, &to.facet_neighbours.offsets}) {
    const std::uint64_t* step = offsets->step();
    if (s.simplicial() && step != nullptr && (*step == s.dimension || offsets->size() == 1)) {
      *offsets = EvenArray<std::uint64_t>::of_step(offsets->size() + s.facets, s.dimension);
      continue;
    }
    Array<std::uint64_t>& ends = offsets->edit();
    std::uint64_t at = ends.back();
    for (std::size_t i = 0; i < s.facets; ++i)
      ends.push_back(at += s.simplicial() ? s.dimension : corners_of(i));
  }
}

/// Sets the measures of a hull in its own dimension, or appends them to a batch.
inline void write_measures(unsigned dimension, std::uint64_t, double volume, double area,
                           const double* centroid, Hull& hull) {
  hull.affine_dimension = static_cast<int>(dimension);
  hull.volume = volume;
  hull.area = area;
  hull.centroid.assign(centroid, centroid + dimension);
}
inline void write_measures(unsigned dimension, std::uint64_t points, double volume, double area,
                           const double* centroid, HullBatch& to) {
  to.point_counts.push_back(points);
  to.affine_dimensions.push_back(static_cast<std::int32_t>(dimension));
  to.volumes.push_back(volume);
  to.areas.push_back(area);
  to.centroids.insert(to.centroids.end(), centroid, centroid + dimension);
}

}  // namespace cullhull::internal
