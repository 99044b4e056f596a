// What an algorithm that grows a surface round by round counts: facets that have points outside of
// them, and these points. On a device the numbers stay there for several rounds, in which the host
// knows the most that they may be.
#pragma once

#include <cstdint>
#include <vector>

#include "filter/pseudo_hull/pseudo_hull.hpp"

namespace cullhull::internal {

template <class Executor>
class GrowthRounds {
 public:
  using Count = typename Executor::Count;

  /// At first all points are outside.
  void begin(std::uint32_t points) {
    left_ = points;
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
    facets_ = facets;
    exterior_ = exterior;
  }
  /// Whether to read(). Until then a round takes as much room as it may need, a multiple of that of
  /// the round before: where that would be much, the numbers are read.
  bool due() const {
    constexpr std::uint32_t much = 1U << 15;
    return unread_.size() >= Executor::rounds_ahead || Executor::most(facets_) > much;
  }
  /// Reads the numbers and adds those of each round to its report.
  void read(std::vector<PseudoHullRound>& reports) {
    for (const Round& r : unread_) {
      const std::uint32_t before = r.before, culled = r.culled, facets = r.facets;
      if (before == 0) break;
      if (reports.size() <= r.number) reports.resize(r.number + 1);
      PseudoHullRound& report = reports[r.number];
      report.facets += facets;
      report.exterior += before;
      report.culled += culled;
      report.kept += before - culled - r.after;
      replaced_ += facets;
      left_ -= culled;
    }
    unread_.clear();
    exterior_ = std::uint32_t{exterior_};
    facets_ = std::uint32_t{facets_};
  }

 private:
  struct Round {
    std::uint32_t number;
    Count facets, before, culled, after;
  };
  std::uint32_t left_ = 0, replaced_ = 0;
  Count exterior_ = 0, facets_ = 0;
  std::vector<Round> unread_;
};

}  // namespace cullhull::internal
