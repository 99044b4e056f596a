// What an algorithm that grows a surface round by round counts: facets that have points outside of
// them, and these points. A device's numbers are read a round late, so that it never waits for the
// host; until then the host knows the most that they may be.
#pragma once

#include <algorithm>
#include <cstdint>
#include <deque>
#include <vector>

#include "filter/pseudo_hull/pseudo_hull.hpp"

namespace cullhull::internal {

template <class Executor>
class GrowthRounds {
 public:
  using Count = typename Executor::Count;

  /// At first all points are outside. A facet is replaced by `fan` facets.
  void begin(std::uint32_t points, std::uint32_t fan) {
    left_ = points;
    fan_ = fan;
    much_ = std::max(1U << 15, points / 8);
    exterior_ = points;
    facets_ = 0;
    replaced_ = 0;
    unread_.clear();
  }
  const Count& exterior() const { return exterior_; }  ///< points outside of the surface
  const Count& facets() const { return facets_; }      ///< the facets that they are assigned to
  /// Points not culled, and facets replaced, in the rounds whose counters have been read.
  std::uint32_t left() const { return left_; }
  std::uint32_t replaced() const { return replaced_; }
  bool done() const { return Executor::most(exterior_) == 0; }

  /// Records a finished round: points culled, facets and points left.
  void add(std::uint32_t round, const Count& culled, const Count& facets, const Count& exterior) {
    unread_.push_back({round, facets_, exterior_, culled, exterior});
    facets_ = Executor::at_most(facets, Executor::most(exterior));  // each has a point outside
    exterior_ = exterior;
  }
  /// Whether room for the most facets that there may be is too much: then their number is read in
  /// the same round. It is on its way before the points move if it is sent then.
  bool are_many(const Count& facets) const {
    return std::min(Executor::most(facets), Executor::most(exterior_)) > much_;
  }
  /// Reads the numbers of all rounds but the last `ahead`, 0 or 1, and adds those of each to its
  /// report.
  void read(std::vector<PseudoHullRound>& reports, std::size_t ahead) {
    if (unread_.size() <= ahead) return;
    std::uint32_t after = 0;
    for (; unread_.size() > ahead; unread_.pop_front()) {
      const Round& r = unread_.front();
      const std::uint32_t before = r.before;
      after = 0;
      if (before == 0) continue;
      const std::uint32_t culled = r.culled, facets = r.facets;
      after = r.after;
      if (reports.size() <= r.number) reports.resize(r.number + 1);
      PseudoHullRound& report = reports[r.number];
      report.facets += facets;
      report.exterior += before;
      report.culled += culled;
      report.kept += before - culled - after;
      replaced_ += facets;
      left_ -= culled;
    }
    exterior_ = Executor::at_most(exterior_, after);
    facets_ = Executor::at_most(facets_, after);
    if (after == 0) return;
    if (unread_.empty() || are_many(facets_))
      facets_ = std::uint32_t{facets_};
    else
      facets_ = Executor::at_most(facets_, fan_ * std::uint32_t{unread_.front().facets});
    if (Executor::most(facets_) == 0) exterior_ = 0;
  }

 private:
  struct Round {
    std::uint32_t number;
    Count facets, before, culled, after;
  };
  std::uint32_t left_ = 0, fan_ = 1, much_ = 0, replaced_ = 0;
  Count exterior_ = 0, facets_ = 0;
  std::deque<Round> unread_;
};

}  // namespace cullhull::internal
