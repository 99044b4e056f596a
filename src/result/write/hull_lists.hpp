// Where the lists of a result go: into a Hull, or behind those of a HullBatch. Who writes a
// canonical result writes it once, for both.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <type_traits>
#include <utility>

#include "cullhull/batch.hpp"
#include "cullhull/hull.hpp"
#include "parallel/memory/raw_array.hpp"
#include "result/build_hull.hpp"

namespace cullhull::internal {

/// Moves the lists of a hull into it whose facets are its simplices. `facets` is empty where
/// facets_are_simplices(k).
inline void keep_simplicial(unsigned k, Array<std::uint64_t>&& simplices,
                            Array<std::uint64_t>&& facets, Array<std::uint32_t>&& neighbours,
                            Array<std::uint32_t>&& across, Hull& hull) {
  using Ids = SharedArray<std::uint64_t>;
  hull.simplices = std::move(simplices);
  hull.simplex_neighbours = std::move(neighbours);
  hull.simplex_facets = EvenArray<std::uint32_t>::of_step(hull.simplices.size() / k, 1);
  hull.facets = Lists<std::uint64_t, Ids>::of_length(
      k, facets.empty() ? hull.simplices : Ids(std::move(facets)));
  hull.facet_neighbours = Lists<std::uint32_t>::of_length(k, std::move(across));
}

/// The sizes of a hull's lists.
struct ListSizes {
  unsigned dimension;  ///< of the hull, which may be less than the points'
  std::size_t vertices, simplices, facets;
  std::size_t corners, across;  ///< the corners of all facets together, and their neighbours

  bool simplicial() const { return facets == simplices; }
};

/// The new lists of a hull, in the order of a Hull, which the caller fills: those of an empty Hull,
/// or behind the lists of a batch. Unless they are kept, the target becomes what it was.
template <class Target>
class NewLists {
  static constexpr bool alone = std::is_same_v<Target, Hull>;

 public:
  /// `room`: this many bytes behind each list but the vertices may be overwritten, so that whole
  /// vectors can be stored, and then there is room for a plane of each simplex and of seven more.
  NewLists(const ListSizes& sizes, Target& to, std::size_t room = 0)
      : sizes_(sizes),
        to_(to),
        room_(room),
        shared_(alone && sizes.simplicial() && facets_are_simplices(sizes.dimension)),
        numbered_(!alone || !sizes.simplicial()),
        simplices(extend(to.simplices, sizes.simplices * sizes.dimension)),
        facets(shared_ ? nullptr : extend(to.facets, sizes.corners)),
        simplex_neighbours(extend(to.simplex_neighbours, sizes.simplices * sizes.dimension)),
        facet_neighbours(extend(to.facet_neighbours, sizes.across)),
        simplex_facets(numbered_ ? extend(to.simplex_facets, sizes.simplices) : nullptr),
        planes(extend(to.facet_planes, (room > 0 ? sizes.simplices + 7 : sizes.facets) * width())) {
  }
  NewLists(const NewLists&) = delete;
  NewLists& operator=(const NewLists&) = delete;
  ~NewLists() {
    if (kept_) return;
    cut(0);
    if constexpr (alone)
      to_.vertices.clear();
    else
      to_.vertices.items.resize(to_.vertices.offsets.back());
  }

  /// Makes room for the vertices. Clearing it takes long for a Hull of many; one thread may do it
  /// while others fill the lists.
  std::uint64_t* vertices() {
    if constexpr (alone) {
      resize_big(to_.vertices, sizes_.vertices);
      return to_.vertices.data();
    } else {
      to_.vertices.items.resize(to_.vertices.items.size() + sizes_.vertices);
      return to_.vertices.items.data() + to_.vertices.items.size() - sizes_.vertices;
    }
  }

  /// The lists are complete, and every facet is a simplex.
  void keep() {
    const auto all = [this](std::size_t) { return sizes_.dimension; };
    keep(all, all);
  }
  /// The same for any facets; numbers that follow from the sizes are filled in. corners_of(i),
  /// across_of(i): how many corners and neighbours facet i has; asked only where some facet is no
  /// simplex.
  template <class CornersOf, class AcrossOf>
  void keep(const CornersOf& corners_of, const AcrossOf& across_of) {
    kept_ = true;
    if (room_ > 0) cut(1);
    add_offsets(to_.facets.offsets, corners_of);
    add_offsets(to_.facet_neighbours.offsets, across_of);
    if constexpr (alone) {
      if (shared_) to_.facets.items = to_.simplices;
      if (!numbered_) to_.simplex_facets = EvenArray<std::uint32_t>::of_step(sizes_.simplices, 1);
    } else {
      if (sizes_.simplicial())
        for (std::size_t i = 0; i < sizes_.simplices; ++i)
          simplex_facets[i] = static_cast<std::uint32_t>(i);
      to_.facet_starts.push_back(to_.facet_starts.back() + sizes_.facets);
      const auto end = [](auto& lists) { lists.offsets.push_back(lists.items.size()); };
      end(to_.vertices), end(to_.simplices), end(to_.simplex_neighbours), end(to_.simplex_facets);
    }
  }

 private:
  const ListSizes sizes_;
  Target& to_;
  const std::size_t room_;
  const bool shared_, numbered_;
  bool kept_ = false;

  /// Numbers of a plane.
  std::size_t width() const { return (alone ? sizes_.dimension : to_.dimension) + std::size_t{1}; }
  /// The array that holds a list.
  static auto& array(auto& list) {
    if constexpr (requires { list.items; })
      return array(list.items);
    else if constexpr (requires { list.edit(); })
      return list.edit();
    else
      return list;
  }
  /// Appends `count` items, and the room behind them, which cut() removes.
  auto* extend(auto& list, std::size_t count) const {
    auto& items = array(list);
    const std::size_t before = items.size();
    items.resize(before + count + room_ / sizeof(items[0]));
    return items.data() + before;
  }
  /// Ends the lists behind their new items, or (`share` = 0) before them.
  void cut(std::size_t share) {
    const auto end = [&](auto& list, auto* begin, std::size_t count) {
      auto& items = array(list);
      items.resize(static_cast<std::size_t>(begin - items.data()) + share * count);
    };
    const std::size_t size = sizes_.simplices * sizes_.dimension;
    end(to_.simplices, simplices, size);
    if (!shared_) end(to_.facets, facets, sizes_.corners);
    end(to_.simplex_neighbours, simplex_neighbours, size);
    end(to_.facet_neighbours, facet_neighbours, sizes_.across);
    if (numbered_) end(to_.simplex_facets, simplex_facets, sizes_.simplices);
    end(to_.facet_planes, planes, sizes_.facets * width());
  }
  template <class Length>
  void add_offsets(EvenArray<std::uint64_t>& offsets, const Length& length) const {
    const std::uint64_t* step = offsets.step();
    if (sizes_.simplicial() && step != nullptr &&
        (*step == sizes_.dimension || offsets.size() == 1)) {
      offsets = EvenArray<std::uint64_t>::of_step(offsets.size() + sizes_.facets, sizes_.dimension);
      return;
    }
    std::uint64_t at = offsets.back();
    for (std::size_t i = 0; i < sizes_.facets; ++i)
      offsets.push_back(at += sizes_.simplicial() ? sizes_.dimension : length(i));
  }

 public:
  std::uint64_t* const simplices;
  std::uint64_t* const facets;  ///< nullptr: shared with `simplices`
  std::uint32_t *const simplex_neighbours, *const facet_neighbours;
  std::uint32_t* const
      simplex_facets;    ///< nullptr, or not to be filled, where facet i is simplex i
  double* const planes;  ///< of all simplices, or of the facets
};

/// Sets the measures of a hull, or appends them to a batch.
inline void write_measures(int dimension, std::uint64_t, double volume, double area,
                           std::span<const double> centroid, Hull& hull) {
  hull.affine_dimension = dimension;
  hull.volume = volume;
  hull.area = area;
  hull.centroid.assign(centroid.begin(), centroid.end());
}
inline void write_measures(int dimension, std::uint64_t points, double volume, double area,
                           std::span<const double> centroid, HullBatch& to) {
  to.point_counts.push_back(points);
  to.affine_dimensions.push_back(dimension);
  to.volumes.push_back(volume);
  to.areas.push_back(area);
  to.centroids.insert(to.centroids.end(), centroid.begin(), centroid.end());
  to.centroids.resize(to.size() * to.dimension, 0);
}

/// Appends a copy of a hull.
inline void append(HullBatch& b, const Hull& h) {
  const auto k = static_cast<unsigned>(std::max(h.affine_dimension, 0));
  NewLists<HullBatch> to({k, h.vertices.size(), h.simplex_count(), h.facet_count(),
                          h.facets.items.size(), h.facet_neighbours.items.size()},
                         b);
  const auto copy = [](const auto& from, auto* at) { std::copy(from.begin(), from.end(), at); };
  copy(h.vertices, to.vertices());
  copy(h.facets.items, to.facets);
  copy(h.facet_neighbours.items, to.facet_neighbours);
  copy(h.facet_planes, to.planes);
  copy(h.simplices, to.simplices);
  copy(h.simplex_neighbours, to.simplex_neighbours);
  copy(h.simplex_facets, to.simplex_facets);
  write_measures(h.affine_dimension, h.point_count, h.volume, h.area, h.centroid, b);
  to.keep([&](std::size_t i) { return h.facets[i].size(); },
          [&](std::size_t i) { return h.facet_neighbours[i].size(); });
}

}  // namespace cullhull::internal
