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
#include <optional>
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

/// Copies vertices, as given.
template <class Rows>
struct CopyVertex {
  Rows rows;
  const std::uint32_t* row;
  double* to;
  CULLHULL_HD void operator()(std::uint32_t i) const { rows.load(row[i], to + 3 * std::size_t{i}); }
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

/// What of a result the host wants: measures and vertex 0; the triangles as well; the rows and
/// coordinates of the vertices as well.
enum class StarWanted { sums, triangles, vertices };
struct StarLists {
  TriangleLists triangles;
  Array<std::uint32_t> rows;
  Array<double> coordinates;
};

/// Computes the result in the executor's memory. Reusable: memory is kept.
template <class Executor, class Rows>
class StarResult {
 public:
  /// `rows`: the `count` rows as they were given to hull.run(). False, before anything is begun,
  /// unless they make a surface that is whole(), and where the coordinates span more than 130
  /// powers of two.
  bool compute(StarHull<Executor, Rows>& hull, const Rows& rows, std::uint32_t count,
               const StarCounts& done) {
    Executor& executor = hull.executor();
    rows_ = rows;
    Rows scaled = rows;
    if (!done.whole() || !scale(executor, hull.box(), scaled, count)) return false;
    left_ = done.left;
    facets_ = done.end.facets;
    std::uint32_t* place = executor.reserve(place_, std::size_t{count} + 1);
    std::uint32_t* row = executor.reserve(row_, left_);
    (void)executor.enumerate(count, NotCulled{hull.culled()}, place,
                             RowOfVertex{hull.culled(), place, row});
    order(executor, hull);
    measure(executor, scaled);
    return true;
  }

  /// Copies the sums to the host and, if wanted, the lists. Null where a plane needs more than
  /// double-doubles.
  std::optional<StarLists> fetch(Executor& executor, const Run& run, StarWanted wanted) {
    StarLists lists;
    TriangleLists& t = lists.triangles;
    std::vector<Share<3, DoubleDouble>> parts(chunk_count(facets_, measure_chunk));
    std::vector<Transfer> transfers;
    const auto copy = [&](const auto& from, auto& list, std::size_t count) {
      list.resize(count);
      transfers.push_back({from.data(), list.data(), count * sizeof list[0]});
    };
    copy(chunks_, parts, parts.size());
    const std::uint32_t vertices = wanted == StarWanted::vertices ? left_ : 1;
    executor.reserve(coordinates_, 3 * std::size_t{vertices});
    executor.for_each(vertices, CopyVertex<Rows>{rows_, row_.data(), coordinates_.data()});
    copy(coordinates_, lists.coordinates, 3 * std::size_t{vertices});
    if (wanted == StarWanted::vertices) copy(row_, lists.rows, left_);
    if (wanted != StarWanted::sums) {
      copy(vertices_, t.vertices, 3 * std::size_t{facets_});
      copy(neighbours_, t.neighbours, 3 * std::size_t{facets_});
      copy(planes_, t.planes, 4 * std::size_t{facets_});
    }
    executor.fetch_all(transfers, run);
    t.exponent = exponent_;
    std::copy_n(lists.coordinates.begin(), 3, t.first);
    if (wanted != StarWanted::vertices) lists.coordinates = {};
    for (const auto& part : parts) t.sums.add(part);
    if (!std::isfinite(t.sums.error)) return {};
    return lists;
  }

  /// The lists in the executor's memory.
  const std::uint32_t* vertices() const { return vertices_.data(); }
  const std::uint32_t* neighbours() const { return neighbours_.data(); }
  const double* planes() const { return planes_.data(); }

 private:
  template <class T>
  using There = typename Executor::template Array<T>;

  /// Scales the rows as make_frame() does; false where that is far from 1 or the hull thin along an
  /// axis.
  bool scale(Executor& executor, const AxisExtremes<3>& box, Rows& rows, std::uint32_t count) {
    double largest = 0;
    for (unsigned k = 0; k < 3; ++k)
      largest = std::max({largest, std::fabs(box.low[k]), std::fabs(box.high[k])});
    exponent_ = largest > 0 ? std::ilogb(largest) + 1 : 0;
    if (std::abs(exponent_) > 1000) return false;
    const double factor = scale_by(1, -exponent_), powers[3] = {factor, factor, factor};
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

  void measure(Executor& executor, const Rows& rows) {
    const auto runs = static_cast<std::uint32_t>(chunk_count(facets_, measure_run));
    const auto chunks = static_cast<std::uint32_t>(chunk_count(facets_, measure_chunk));
    Share<3>* sums = executor.reserve(runs_, runs);
    executor.for_each(
        runs, MeasureRun<Rows>{rows, row_.data(), vertices_.data(), facets_, scale_by(1, exponent_),
                               executor.reserve(planes_, 4 * std::size_t{facets_}), sums});
    executor.for_each(chunks, SumChunk{sums, runs, executor.reserve(chunks_, chunks)});
  }

  std::uint32_t left_ = 0, facets_ = 0;
  Rows rows_{};  ///< as given
  int exponent_ = 0;
  There<std::uint32_t> place_, row_, listed_, by_second_, by_lowest_, slot_, number_;
  There<std::uint32_t> vertices_, neighbours_;
  There<double> planes_, coordinates_;
  There<Share<3>> runs_;
  There<Share<3, DoubleDouble>> chunks_;
};

}  // namespace cullhull::internal
