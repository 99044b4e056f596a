// The hull of points in space as far as doubles decide it: a star-shaped surface grown from the
// points and made convex by flips. What is culled is strictly inside, whatever else is true; that
// the surface is the hull is for exact arithmetic to show. The same text for every executor.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "filter/star_hull/star_flips.hpp"
#include "filter/star_hull/star_growth.hpp"
#include "filter/star_hull/star_triangles.hpp"

namespace cullhull::internal::inline filter {

/// What was done, and what is left.
struct StarCounts {
  std::uint32_t vertices = 0, facets = 0;  ///< after the growth
  std::uint32_t left = 0;                  ///< rows that are not culled in the end
  std::uint32_t aside = 0;                 ///< of them, those that are no vertices
  std::uint32_t flip_rounds = 0;
  std::uint32_t flips = 0;  ///< on a device those of every eighth round alone
  double growth_seconds = 0, flip_seconds = 0;
  StarReport end;
  /// Every edge is certainly convex, and every row is a vertex or inside.
  bool whole() const {
    return end.facets != 0 && aside == 0 && end.reflex == 0 && end.uncertain == 0;
  }
};

struct FacetIsLive {
  const StarFacet* facet;
  CULLHULL_HD bool operator()(std::uint32_t f) const { return facet[f].live(); }
};
struct EmitTriangle {
  const StarFacet* facet;
  const std::uint32_t* row_rank;
  const std::uint32_t* facet_rank;
  std::uint32_t* vertices;
  std::uint32_t* neighbours;
  CULLHULL_HD void operator()(std::uint32_t f) const {
    if (!facet[f].live()) return;
    for (unsigned k = 0; k < 3; ++k) {
      const std::size_t at = 3 * std::size_t{facet_rank[f]} + k;
      vertices[at] = row_rank[facet[f].vertex[k]];
      neighbours[at] = facet_rank[facet[f].across[k].facet()];
    }
  }
};

/// Finds the surface. Reusable: memory is kept.
template <class Executor, class Rows>
class StarHull {
 public:
  explicit StarHull(Executor executor) : growth_(std::move(executor)) {}

  StarCounts run(const Rows& rows, std::uint32_t count, unsigned max_rounds, const Control& control,
                 std::vector<PseudoHullRound>& rounds) {
    StarCounts done;
    count_ = count;
    const Clock::time_point start = Clock::now();
    if (!growth_.run(rows, count, max_rounds, control, rounds)) {
      done.left = count;
      return done;
    }
    done.facets = growth_.facet_count();
    done.vertices = done.facets / 2 + 2;
    done.aside = growth_.left() - done.vertices;
    done.growth_seconds = seconds_since(start);
    flip(control, done);
    done.flip_seconds = seconds_since(start) - done.growth_seconds;
    done.left = done.aside + done.end.facets / 2 + 2;
    return done;
  }
  const unsigned char* culled() { return growth_.culled(); }
  Executor& executor() { return growth_.executor(); }

  /// The triangles of a surface that is whole(). Vertices are numbered as their rows ascend.
  StarTriangles triangles(const StarCounts& done) {
    Executor& executor = growth_.executor();
    const std::uint32_t slots = growth_.facet_count();
    std::uint32_t* row_rank = executor.reserve(row_rank_, std::size_t{count_} + 1);
    std::uint32_t* facet_rank = executor.reserve(facet_rank_, std::size_t{slots} + 1);
    const auto rows = executor.enumerate(count_, NotCulled{growth_.culled()}, row_rank);
    const auto facets = executor.enumerate(slots, FacetIsLive{growth_.facets()}, facet_rank);
    std::uint32_t* out = executor.reserve(out_, 6 * std::size_t{done.end.facets});
    std::uint32_t* across = out + 3 * std::size_t{done.end.facets};
    executor.for_each(slots, EmitTriangle{growth_.facets(), row_rank, facet_rank, out, across});
    StarTriangles found;
    executor.settle(rows, facets);
    if (rows != done.left || facets != done.end.facets) return found;
    found.vertices.resize(3 * std::size_t{facets});
    found.neighbours.resize(3 * std::size_t{facets});
    executor.fetch(out, found.vertices.size(), found.vertices.data());
    executor.fetch(across, found.neighbours.size(), found.neighbours.data());
    return found;
  }

 private:
  /// Flips until a round flips nothing. A device is asked whether one did only now and then: a
  /// round takes it little longer than the question.
  void flip(const Control& control, StarCounts& done) {
    constexpr unsigned between = Executor::many_threads ? 8 : 1;
    Executor& executor = growth_.executor();
    const std::uint32_t facets = growth_.facet_count();
    StarFlips<Rows> flips{growth_.rows(), {}, growth_.facets(), growth_.culled(), 0};
    std::copy_n(growth_.centre(), 3, flips.centre);
    std::uint64_t* claim = executor.reserve(claim_, facets);
    unsigned char* proposal = executor.reserve(proposal_, facets);
    unsigned char* waiting = executor.reserve(waiting_, facets);
    executor.for_each(facets, StartWaiting{claim, waiting});
    std::uint32_t flipped = 1;
    while (flipped != 0) {
      control.check();
      ++flips.round;
      const ProposeFlip<Executor, Rows> propose{flips, claim, proposal, waiting};
      const PerformFlip<Rows> perform{flips, claim, proposal, waiting};
      executor.for_each(facets, propose);
      if (flips.round % between != 0) {
        executor.for_each(facets, PerformUncounted<Rows>{perform});
      } else {
        flipped = executor.reduce(facets, std::uint32_t{0}, perform, AddNumbers{});
        done.flips += flipped;
      }
    }
    done.flip_rounds = flips.round;
    done.end = executor.reduce(facets, StarReport{}, ReportFacet<Rows>{flips}, AddReports{});
  }
  template <class T>
  using Array = typename Executor::template Array<T>;

  StarGrowth<Executor, Rows> growth_;
  std::uint32_t count_ = 0;
  Array<std::uint64_t> claim_;
  Array<unsigned char> proposal_, waiting_;
  Array<std::uint32_t> row_rank_, facet_rank_, out_;
};

}  // namespace cullhull::internal::inline filter
