// The hull of points in space as far as doubles decide it: a star-shaped surface grown from the
// points and made convex by flips. What is culled is strictly inside, whatever else is true. The
// same text for every executor.
#pragma once

#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

#include "filter/star_hull/star_flips.hpp"
#include "filter/star_hull/star_growth.hpp"

namespace cullhull::internal {

// A surface that is whole() is the hull (docs/exactness.md, H6); one that is not has still culled
// points, and its vertices with those set aside are hulled like any filter's survivors.

/// What was done, and what is left.
struct StarCounts {
  std::uint32_t leaders = 0;               ///< vertices of the first surface; 4: a simplex
  bool moved = false;                      ///< the first surface was that of the last frame
  std::uint32_t vertices = 0, facets = 0;  ///< after the growth
  std::uint32_t left = 0;                  ///< rows that are not culled in the end
  std::uint32_t aside = 0;                 ///< of them, those that are no vertices
  std::uint32_t flip_rounds = 0;
  std::uint32_t flips = 0;  ///< counted on the host alone
  std::uint32_t dooms = 0;  ///< times flipping stalled and vertices were marked for removal
  double growth_seconds = 0, flip_seconds = 0;
  StarReport end;
  /// Every edge is certainly convex, and every row is a vertex or inside.
  bool whole() const {
    return end.facets != 0 && aside == 0 && end.reflex == 0 && end.uncertain == 0;
  }
};

struct EmitItem {
  std::uint32_t* list;
  CULLHULL_HD void operator()(std::uint32_t i, std::uint32_t k) const { list[k] = i; }
};

/// Finds the surface. Reusable: memory is kept.
template <class Executor, class Rows>
class StarHull {
 public:
  explicit StarHull(Executor executor) : growth_(std::move(executor)) {}

  StarCounts run(const Rows& rows, std::uint32_t count, unsigned max_rounds, const Control& control,
                 std::vector<PseudoHullRound>& rounds, StarBegin begin = StarBegin::any) {
    StarCounts done;
    count_ = count;
    const Clock::time_point start = Clock::now();
    if (!growth_.run(rows, count, max_rounds, control, rounds, begin)) {
      done.left = count;
      return done;
    }
    done.facets = growth_.facet_count();
    done.leaders = growth_.first_facets() / 2 + 2;
    done.moved = growth_.moved();
    done.vertices = done.facets / 2 + 2;
    done.aside = growth_.left() - done.vertices;
    done.growth_seconds = seconds_since(start);
    flip(control, done);
    done.flip_seconds = seconds_since(start) - done.growth_seconds;
    done.left = done.aside + done.end.facets / 2 + 2;
    return done;
  }
  /// Keeps a surface that is whole() for the next run(), which begins with it if as many rows are
  /// given and it is star-shaped where they are now: moving points.
  void keep(const StarCounts& done) { growth_.keep(done.end.facets); }
  const AxisExtremes<3>& box() const { return growth_.box(); }  ///< of the rows as given to run()
  const unsigned char* culled() { return growth_.culled(); }
  Executor& executor() { return growth_.executor(); }

  /// The surface, in the executor's memory: slots() facets, some of which flips have removed.
  const StarFacet* facets() { return growth_.facets(); }
  std::uint32_t slots() const { return growth_.facet_count(); }

 private:
  // The order of events: rounds of flips until no side waits; a report of what is left; if reflex
  // edges are left, vertices at them are marked as doomed where that is proved, and rounds go on
  // with the sides around these. It ends when no reflex edge is left, when nothing can be marked,
  // or after a fixed number of rounds: then the surface is not whole, and the CPU hulls the points
  // that are left.

  /// Flips until all edges are convex or nothing can be flipped.
  void flip(const Control& control, StarCounts& done) {
    using Rounds = FlipRounds<Executor, Rows>;
    // There is an end (docs/exactness.md, H5); where it is far, the rest is the CPU's. Seventy
    // rounds are usual.
    constexpr std::uint32_t most_rounds = 2048;
    Executor& executor = growth_.executor();
    const std::uint32_t facets = growth_.facet_count(), sides = 3 * facets;  // 6 of 2^28 points
    StarFlips<Rows> flips{growth_.rows(), {}, growth_.facets(), growth_.culled(), nullptr};
    std::copy_n(growth_.centre(), 3, flips.centre);
    std::uint32_t* count = executor.reserve(flip_counts_, most_rounds + 3);
    executor.zero(count, most_rounds + 3);
    Rounds rounds{flips,
                  executor.reserve(claim_, facets),
                  executor.reserve(waiting_, sides),
                  executor.reserve(proposal_, sides),
                  {nullptr, nullptr},
                  executor.reserve(number_of_facet_, facets),
                  count,
                  Executor::many_threads ? nullptr : count + most_rounds + 2};
    executor.for_each(facets, StartFlips<Executor, Rows>{rounds});
    std::uint32_t round = 1;
    // Flipping rarely stalls before all edges are convex, and seldom again after vertices were
    // marked for removal.
    constexpr unsigned most_dooms = 16;
    for (unsigned dooms = 0;; ++dooms) {
      const Count few = flip_while_sides_wait(rounds, facets, round, most_rounds, control);
      executor.send_counts();
      done.end = executor.reduce(facets, StarReport{}, ReportFacet<Rows>{flips}, AddReports{});
      round += few;  // sent before what was waited for
      done.dooms = dooms;
      if (done.end.reflex == 0 || dooms == most_dooms || round > most_rounds) break;
      if (dooms == 0) executor.zero(executor.reserve(doomed_, count_), count_);
      unsigned char* doomed = doomed_.data();
      if (executor.reduce(sides, std::uint32_t{0}, DoomEnds<Rows>{flips, doomed}, AddNumbers{}) ==
          0)
        break;
      rounds.flips.doomed = doomed;
      executor.for_each(sides, WakeDoomed{growth_.facets(), doomed, rounds.waiting});
    }
    done.flip_rounds = round - 1;
    if (rounds.flipped != nullptr) executor.fetch(rounds.flipped, 1, &done.flips);
  }

  using Count = typename Executor::Count;

  /// From `round` on: rounds for all sides while many wait, then by lists of the few; returns the
  /// number of these. A device that many sides wait for does not wait for the host.
  template <class Rounds>
  Count flip_while_sides_wait(Rounds& rounds, std::uint32_t facets, std::uint32_t& round,
                              std::uint32_t most_rounds, const Control& control) {
    Executor& executor = growth_.executor();
    const std::uint32_t sides = 3 * facets;
    std::uint32_t* const list[2] = {executor.reserve(listed_, std::size_t{facets} + 1),
                                    executor.reserve(order_, std::size_t{facets} + 1)};
    const auto list_waiting = [&] {
      return executor.append(facets, FacetWaits{rounds.waiting},
                             ListForRound{list[round % 2], rounds.listed_for, round});
    };
    Count waiting = round == 1 ? Count(facets) : list_waiting();  // at first all sides wait
    while (round <= most_rounds) {
      control.check();
      const std::uint32_t seen = waiting;
      if (seen == 0) break;
      if (seen <= Executor::few_items) {
        Rounds listed = rounds;
        std::copy_n(list, 2, listed.listed);
        return executor.rounds(listed, round, most_rounds, list_waiting(), control);
      }
      const std::uint32_t end = std::min(most_rounds + 1, round + Executor::rounds_at_once);
      for (; round < end; ++round) {
        if (round + Executor::rounds_after_look == end) {
          waiting = list_waiting();
          executor.send_counts();
        }
        executor.for_each_where(sides, SideIsMarked{rounds.waiting},
                                FlipStep<Rounds, true>{rounds, round});
        executor.for_each_where(sides, SideIsMarked{rounds.proposal},
                                FlipStep<Rounds, false>{rounds, round});
      }
    }
    return 0;
  }
  template <class T>
  using Array = typename Executor::template Array<T>;

  StarGrowth<Executor, Rows> growth_;
  std::uint32_t count_ = 0;
  Array<FlipClaim> claim_;
  Array<unsigned char> waiting_, proposal_, doomed_;
  Array<std::uint32_t> number_of_facet_, listed_, order_, flip_counts_;
};

}  // namespace cullhull::internal
