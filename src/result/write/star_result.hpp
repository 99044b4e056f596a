// The canonical result of a star-shaped surface that is whole(), by the executor that found it and
// where the points are. Its edges are certainly convex and it covers every direction from its
// centre once, so its triangles are the facets of the hull (docs/exactness.md, H6): what is left to
// do is their order, planes and measures.
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include "filter/star_hull/star_hull.hpp"
#include "result/facets/facet_math.hpp"
#include "result/write/triangle_lists.hpp"

namespace cullhull::internal {

/// Writes the row of each vertex, of which `number` counts those before a row.
struct RowOfVertex {
  const unsigned char* culled;
  const std::uint32_t* number;
  std::uint32_t* row;
  CULLHULL_HD void operator()(std::uint32_t i) const {
    if (culled[i] == 0) row[number[i]] = i;
  }
};

// Canonical order: a triangle begins with its lowest vertex, and triangles are sorted by their
// lowest and then their second vertex, in which any two differ: a directed edge has one triangle.
// So two stable sorts do: by the second vertex, then by the lowest.

/// The facets as the result stores them: `place` numbers the vertices by ascending row.
struct StoredFacets {
  const StarFacet* facet;
  const std::uint32_t* place;
  CULLHULL_HD std::uint32_t vertex(std::uint32_t f, unsigned corner) const {
    return place[facet[f].vertex[corner]];
  }
  /// The corner with the lowest vertex.
  CULLHULL_HD unsigned first(std::uint32_t f) const {
    const std::uint32_t v[3] = {vertex(f, 0), vertex(f, 1), vertex(f, 2)};
    if (v[0] < v[1]) return v[0] < v[2] ? 0 : 2;
    return v[1] < v[2] ? 1 : 2;
  }
};
/// A vertex of listed facet i, or of that which comes i-th by `order`: the lowest, or the second.
struct StoredVertex {
  StoredFacets facets;
  const std::uint32_t* listed;
  const std::uint32_t* order;  ///< null: 0, 1, ...
  bool second;
  CULLHULL_HD std::uint32_t operator()(std::uint32_t i) const {
    const std::uint32_t f = listed[order == nullptr ? i : order[i]];
    const unsigned first = facets.first(f);
    return facets.vertex(f, second ? next_corner(first) : first);
  }
};
/// Numbers the facets in canonical order.
struct NumberFacets {
  const std::uint32_t* listed;
  const std::uint32_t* by_second;
  const std::uint32_t* by_lowest;
  std::uint32_t* slot;    ///< of triangle i
  std::uint32_t* number;  ///< of the facet in a slot
  CULLHULL_HD void operator()(std::uint32_t i) const {
    slot[i] = listed[by_second[by_lowest[i]]];
    number[slot[i]] = i;
  }
};
struct WriteTriangle {
  StoredFacets facets;
  const std::uint32_t* slot;
  const std::uint32_t* number;
  std::uint32_t* vertices;
  std::uint32_t* neighbours;
  CULLHULL_HD void operator()(std::uint32_t i) const {
    const std::uint32_t f = slot[i];
    unsigned corner = facets.first(f);
    for (std::size_t at = 3 * std::size_t{i}; at < 3 * std::size_t{i} + 3; ++at) {
      vertices[at] = facets.vertex(f, corner);
      neighbours[at] = number[facets.facet[f].across[corner].facet()];
      corner = next_corner(corner);
    }
  }
};

/// Writes the planes of a run of triangles and the sum of their shares, in the operations and the
/// order that every other way uses. The sum's error is infinite where doubles and double-doubles do
/// not suffice.
template <class Rows>
struct MeasureRun {
  Rows rows;  ///< scaled as a Frame is
  const std::uint32_t* row;
  const std::uint32_t* vertices;
  std::uint32_t count;
  double unit;
  double* planes;
  Share<3>* runs;
  CULLHULL_HD void operator()(std::uint32_t r) const {
    constexpr auto length = static_cast<std::uint32_t>(measure_run);
    const std::uint32_t begin = r * length, end = count - begin < length ? count : begin + length;
    double origin[3];
    rows.load(row[0], origin);
    Share<3> sum;
    for (std::uint32_t i = begin; i < end; ++i) {
      double corner[3][3], plane[4];
      for (unsigned j = 0; j < 3; ++j) rows.load(row[vertices[3 * std::size_t{i} + j]], corner[j]);
      Share<3> share;
      if (!plain_facet<3>(corner, origin, unit, plane, share) &&
          !careful_facet<3>(corner, origin, unit, plane, share))
        share.error = std::numeric_limits<double>::infinity();
      for (unsigned c = 0; c < 4; ++c) planes[4 * std::size_t{i} + c] = plane[c];
      sum.add(share);
    }
    runs[r] = sum;
  }
};
/// Sums the runs of a chunk.
struct SumChunk {
  static constexpr auto length = static_cast<std::uint32_t>(measure_chunk / measure_run);
  const Share<3>* runs;
  std::uint32_t count;
  Share<3, DoubleDouble>* sums;
  CULLHULL_HD void operator()(std::uint32_t c) const {
    const std::uint32_t begin = c * length, end = count - begin < length ? count : begin + length;
    Share<3, DoubleDouble> sum;
    for (std::uint32_t r = begin; r < end; ++r) sum.add(runs[r]);
    sums[c] = sum;
  }
};

/// Leaves vertex 0, as given, behind the chunks' sums: one copy to the host for both.
template <class Rows>
struct FirstVertex {
  Rows rows;
  const std::uint32_t* row;
  Share<3, DoubleDouble>* behind;
  CULLHULL_HD void operator()(std::uint32_t) const {
    double x[3];
    rows.load(row[0], x);
    Share<3, DoubleDouble> kept;
    for (unsigned k = 0; k < 3; ++k) kept.moment[k] = DoubleDouble{x[k], 0};
    *behind = kept;
  }
};

/// The ids of corners, from their vertices' numbers.
struct NameCorner {
  const std::uint32_t* vertices;
  const std::uint64_t* ids;
  std::int64_t* named;
  CULLHULL_HD void operator()(std::uint32_t i) const {
    named[i] = static_cast<std::int64_t>(ids[vertices[i]]);
  }
};

/// Computes the result in the executor's memory. Reusable: memory is kept.
template <class Executor, class Rows>
class StarResult {
 public:
  /// `rows`: the `count` rows as they were given to hull.run(). False unless they make a surface
  /// that is whole(), and where a plane needs more than double-doubles or the coordinates span more
  /// than 130 powers of two.
  bool compute(StarHull<Executor, Rows>& hull, Rows rows, std::uint32_t count,
               const StarCounts& done) {
    if (!done.whole()) return false;
    Executor& executor = hull.executor();
    left_ = done.left;
    facets_ = done.end.facets;
    std::uint32_t* place = executor.reserve(place_, std::size_t{count} + 1);
    std::uint32_t* row = executor.reserve(row_, left_);
    (void)executor.enumerate(count, NotCulled{hull.culled()}, place,
                             RowOfVertex{hull.culled(), place, row});
    order(executor, hull);
    auto* last = executor.reserve(chunks_, chunk_count(facets_, measure_chunk) + 1);
    executor.for_each(1, FirstVertex<Rows>{rows, row, last + chunk_count(facets_, measure_chunk)});
    return scale(executor, hull.box(), rows, count) && measure(executor, rows);
  }

  /// What is not a list, and the lists in the executor's memory.
  const TriangleLists& sums() const { return sums_; }
  const std::uint32_t* vertices() const { return vertices_.data(); }
  const std::uint32_t* neighbours() const { return neighbours_.data(); }
  const double* planes() const { return planes_.data(); }

  /// Copies the result to the host.
  TriangleLists fetch(Executor& executor, const Run& run) const {
    TriangleLists lists = sums_;
    lists.vertices.resize(3 * std::size_t{facets_});
    lists.neighbours.resize(3 * std::size_t{facets_});
    lists.planes.resize(4 * std::size_t{facets_});
    executor.fetch_many(vertices_.data(), lists.vertices.size(), lists.vertices.data(), run);
    executor.fetch_many(neighbours_.data(), lists.neighbours.size(), lists.neighbours.data(), run);
    executor.fetch_many(planes_.data(), lists.planes.size(), lists.planes.data(), run);
    return lists;
  }

 private:
  /// Scales the rows as make_frame() does; false where that is far from 1 or the hull thin along an
  /// axis.
  bool scale(Executor& executor, const AxisExtremes<3>& box, Rows& rows, std::uint32_t count) {
    double largest = 0;
    for (unsigned k = 0; k < 3; ++k)
      largest = std::max({largest, std::fabs(box.low[k]), std::fabs(box.high[k])});
    sums_.exponent = largest > 0 ? std::ilogb(largest) + 1 : 0;
    if (std::abs(sums_.exponent) > 1000) return false;
    const double factor = scale_by(1, -sums_.exponent), powers[3] = {factor, factor, factor};
    rows.rescale(executor, count, powers);
    // A Frame wants extents above 2^(-400 / 3).
    for (unsigned k = 0; k < 3; ++k)
      if (!(box.high[k] * factor - box.low[k] * factor > 0x1p-133)) return false;
    return true;
  }

  void order(Executor& executor, StarHull<Executor, Rows>& hull) {
    const std::uint32_t slots = hull.slots();
    std::uint32_t* listed = executor.reserve(listed_, std::size_t{slots} + 1);
    (void)executor.select(slots, FacetIsLive{hull.facets()}, EmitItem{listed});
    const StoredFacets facets{hull.facets(), place_.data()};
    const auto bits = static_cast<unsigned>(std::bit_width(left_));
    const std::uint32_t* by_second =
        executor.sort(facets_, StoredVertex{facets, listed, nullptr, true}, bits, by_second_);
    const std::uint32_t* by_lowest =
        executor.sort(facets_, StoredVertex{facets, listed, by_second, false}, bits, by_lowest_);
    std::uint32_t* slot = executor.reserve(slot_, facets_);
    std::uint32_t* number = executor.reserve(number_, slots);
    executor.for_each(facets_, NumberFacets{listed, by_second, by_lowest, slot, number});
    executor.for_each(
        facets_,
        WriteTriangle{facets, slot, number, executor.reserve(vertices_, 3 * std::size_t{facets_}),
                      executor.reserve(neighbours_, 3 * std::size_t{facets_})});
  }

  bool measure(Executor& executor, const Rows& rows) {
    const auto runs = static_cast<std::uint32_t>(chunk_count(facets_, measure_run));
    const auto chunks = static_cast<std::uint32_t>(chunk_count(facets_, measure_chunk));
    Share<3>* sums = executor.reserve(runs_, runs);
    executor.for_each(
        runs,
        MeasureRun<Rows>{rows, row_.data(), vertices_.data(), facets_, scale_by(1, sums_.exponent),
                         executor.reserve(planes_, 4 * std::size_t{facets_}), sums});
    executor.for_each(chunks, SumChunk{sums, runs, chunks_.data()});
    std::vector<Share<3, DoubleDouble>> parts(chunks + std::size_t{1});
    executor.fetch(chunks_.data(), parts.size(), parts.data());
    for (unsigned k = 0; k < 3; ++k) sums_.first[k] = parts.back().moment[k].value();
    parts.pop_back();
    sums_.sums = {};
    for (const auto& part : parts) sums_.sums.add(part);
    return std::isfinite(sums_.sums.error);
  }

  template <class T>
  using Array = typename Executor::template Array<T>;

  std::uint32_t left_ = 0, facets_ = 0;
  TriangleLists sums_;  ///< without the lists
  Array<std::uint32_t> place_, row_, listed_, by_second_, by_lowest_, slot_, number_;
  Array<std::uint32_t> vertices_, neighbours_;
  Array<double> planes_;
  Array<Share<3>> runs_;
  Array<Share<3, DoubleDouble>> chunks_;
};

}  // namespace cullhull::internal
