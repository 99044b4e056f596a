// One pseudo-hull, grown round by round over the data-parallel primitives (the paper's Algorithm
// 1). The same text for every executor and for any kind of rows.
#pragma once

#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

#include "filter/pseudo_hull/growth_rounds.hpp"
#include "filter/pseudo_hull/primitives.hpp"
#include "filter/pseudo_hull/pseudo_hull.hpp"
#include "filter/pseudo_hull/pseudo_hull_math.hpp"
#include "filter/pseudo_hull/pseudo_hull_start.hpp"
#include "filter/pseudo_hull/pseudo_hull_steps.hpp"
#include "parallel/threads/parallel.hpp"

namespace cullhull::internal {

// Why rounds end: each facet of a round has an apex, the farthest point of its exterior set, which
// becomes a vertex and leaves the set. So the number of exterior points falls by at least the
// number of facets each round. Random points of a ball take 13 to 16 rounds.

/// Grows one pseudo-hull. Reusable: memory is kept from one subset to the next.
template <unsigned D, class Executor, class Rows>
class PseudoHullGrowth {
 public:
  explicit PseudoHullGrowth(Executor executor) : executor_(std::move(executor)) {}

  /// Grows until no exterior set is left; afterwards culled()[i] is 1 if row i is strictly inside,
  /// else 0. Adds to `rounds`, extending it if needed.
  void run(const Rows& rows, std::uint32_t count, unsigned max_rounds, const Control& control,
           std::vector<PseudoHullRound>& rounds) {
    if (!start(rows, count, rounds)) {
      executor_.zero(executor_.reserve(culled_, count), count);
      return;
    }
    for (std::uint32_t r = 1; r <= max_rounds && !growth_.done(); ++r) {
      control.check();
      round(r, rounds);
    }
    growth_.read(rounds, 0);
  }
  /// The number of rows that are not culled.
  std::uint32_t left() const { return growth_.left(); }
  /// One byte per row, in the executor's memory.
  const unsigned char* culled() const { return culled_.data(); }
  Executor& executor() { return executor_; }

  /// Makes each later run record which simplex culled a row: simplex_of()[row], no_item if none
  /// did; simplex s has the rows corners()[s (D + 1) ... (s + 1) (D + 1)). Only for executors on
  /// the host.
  void record() { recording_ = true; }
  const std::vector<std::uint32_t>& simplex_of() const { return simplex_of_; }
  const std::vector<std::uint32_t>& corners() const { return corners_; }

  // For tests.
  std::vector<PseudoFacet<D>> facets() { return fetched(facet_.data(), growth_.facets()); }
  std::vector<std::uint32_t> apexes() { return fetched(apex_.data(), growth_.facets()); }
  std::vector<ExteriorPoint> exterior() { return fetched(points_.data(), growth_.exterior()); }

  /// Algorithm 1's first part: builds the simplex and the exterior sets of its facets. Returns
  /// false if there is no simplex; then nothing is culled.
  bool start(const Rows& rows, std::uint32_t count, std::vector<PseudoHullRound>& rounds) {
    rows_ = rows;
    count_ = count;
    growth_.begin(count, D);
    corners_.clear();
    if (recording_) simplex_of_.assign(count, no_item);
    const AxisExtremes<D> e = extremes_of<D>(executor_, rows_, count).get();
    double scale[D];
    if (!axis_scales(e, scale)) return false;
    rows_.rescale(executor_, count, scale);
    StartSimplex<D> simplex;
    if (!choose_simplex(executor_, reader_, rows_, count, e, simplex)) return false;
    StartFacets<D> first;
    if (!first_facets(simplex, first)) return false;
    if (recording_) corners_.assign(simplex.row, simplex.row + D + 1);
    assign_first(first);
    growth_.read(rounds, 0);
    return true;
  }

  // One round, in numbers of 3D: K facets have the cells 0 .. 3 K - 1. Facet j writes its three new
  // facets at j, K + 2 j and K + 2 j + 1. Each exterior point finds the nearest of the three that
  // it is outside of, offers its distance to that cell, or is culled. Cells without an offer are
  // null: they vanish when the others are numbered by a scan. Nothing is sorted, and the only
  // shared writes are maxima.

  /// Replaces every facet (each has an exterior set) by the D facets through its apex.
  void round(std::uint32_t r, std::vector<PseudoHullRound>& rounds) {
    // The most facets that there may be stand for their number where only an order is wanted.
    const Count facets = growth_.facets();
    const std::uint32_t most = Executor::most(facets), cells = most * D;
    executor_.reserve(fan_, most);
    executor_.reserve(cell_, cells);
    const ReplaceFacet<D, Rows> replace{rows_,        most,        facet_.data(),
                                        apex_.data(), fan_.data(), cell_.data()};
    if constexpr (Executor::many_threads)
      executor_.for_each(Executor::times(facets, D), ReplaceFacetInParts<D, Rows>{replace});
    else
      executor_.for_each(facets, replace);
    const Count culled =
        executor_.scatter_max(growth_.exterior(), cells,
                              Reassign<D, Rows>{rows_, most, points_.data(), fan_.data(), arrays()},
                              executor_.reserve(best_, cells));
    if (recording_) record_round();
    regroup(r, cells, points_.data(), culled);
    growth_.read(rounds, Executor::rounds_ahead);
  }

 private:
  using Count = typename Executor::Count;

  template <class T>
  std::vector<T> fetched(const T* from, std::size_t count) {
    std::vector<T> items(count);
    if (count != 0) executor_.fetch(from, count, items.data());
    return items;
  }
  PlaceArrays arrays() { return {place_.data(), distance_.data(), culled_.data()}; }

  /// Puts the D + 1 facets of the simplex into the facet stream and computes their planes.
  bool first_facets(const StartSimplex<D>& simplex, StartFacets<D>& first) {
    Put<PseudoFacet<D>, D + 1> put{};
    auto& facet = put.items;
    for (unsigned f = 0; f <= D; ++f) {
      const double* corner[D];
      for (unsigned k = 0, v = 0; v <= D; ++v) {
        if (v == f) continue;
        facet[f].vertex[k] = simplex.row[v];
        corner[k++] = simplex.corner[v];
      }
      std::copy_n(corner[0], D, first.base[f]);
      if (!make_plane<D>(corner, simplex.corner[f], first.plane[f])) return false;
    }
    put.to = executor_.reserve(cell_, D + 1);
    executor_.for_each(D + 1, put);
    return true;
  }

  void assign_first(const StartFacets<D>& first) {
    executor_.reserve(place_, count_);
    executor_.reserve(distance_, count_);
    executor_.reserve(culled_, count_);
    const auto culled =
        executor_.scatter_max(count_, D + 1, AssignFirst<D, Rows>{rows_, first, arrays()},
                              executor_.reserve(best_, D + 1));
    if (recording_)
      for (std::uint32_t i = 0; i < count_; ++i)
        if (culled_.data()[i] != 0) simplex_of_[i] = 0;
    regroup(0, D + 1, nullptr, culled);
  }

  /// Removes the null cells of the facet stream and the points that are culled or survive, and
  /// finds each facet's apex.
  void regroup(std::uint32_t r, std::uint32_t cells, const ExteriorPoint* from,
               const Count& culled) {
    std::uint32_t* number = executor_.reserve(number_, std::size_t{cells} + 1);
    // Room for as many as there can be: their numbers may be read rounds later.
    PseudoFacet<D>* facet = executor_.reserve(facet_, cells);
    std::uint32_t* apex = executor_.reserve(apex_, cells);
    const Count facets =
        executor_.enumerate(cells, CellHasPoints{best_.data()}, number,
                            MoveFacet<D>{best_.data(), number, cell_.data(), facet, apex});
    if (growth_.are_many(facets)) executor_.send_counts();
    const Count before = growth_.exterior();
    // Room for one more, because an executor may emit an item that is not kept.
    ExteriorPoint* to = executor_.reserve(next_points_, std::size_t{Executor::most(before)} + 1);
    const Count exterior =
        executor_.append(before, HasFacet{place_.data()},
                         MovePoint<Executor>{cells, best_.data(), number, place_.data(),
                                             distance_.data(), from, to, apex});
    std::swap(points_, next_points_);
    executor_.send_counts();
    growth_.add(r, culled, facets, exterior);
  }

  /// Each facet with its apex is a simplex; those of a round are stored consecutively.
  void record_round() {
    const auto first = static_cast<std::uint32_t>(corners_.size() / (D + 1));
    for (std::uint32_t j = 0; j < growth_.facets(); ++j) {
      const std::uint32_t* vertex = facet_.data()[j].vertex;
      corners_.insert(corners_.end(), vertex, vertex + D);
      corners_.push_back(apex_.data()[j]);
    }
    for (std::uint32_t i = 0; i < growth_.exterior(); ++i)
      if (place_.data()[i] == place_inside)
        simplex_of_[points_.data()[i].row] = first + points_.data()[i].facet;
  }

  template <class T>
  using Array = typename Executor::template Array<T>;

  Executor executor_;
  Rows rows_{};
  std::uint32_t count_ = 0;
  GrowthRounds<Executor> growth_;
  Array<ExteriorPoint> points_, next_points_;
  Array<std::uint32_t> place_, apex_, number_;
  Array<double> distance_;
  Array<unsigned char> culled_;
  Array<std::uint64_t> best_;
  Array<PseudoFacet<D>> facet_, cell_;
  Array<PseudoFan<D>> fan_;
  RowReader<D, Rows, Executor> reader_;
  bool recording_ = false;
  std::vector<std::uint32_t> simplex_of_, corners_;
};

}  // namespace cullhull::internal
