// Several threads insert points into one triangulation; each holds the cells it examines. The
// result does not depend on the order of insertion: a symbolic perturbation breaks ties, so that
// there is only one triangulation.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "delaunay/cell_insertion.hpp"
#include "exact/points/local_points.hpp"
#include "parallel/threads/run.hpp"

namespace cullhull::internal {

// Why the order of threads does not matter. A thread holds all cells of its cavity and all around
// it from before it changes the first until it lets go. So between taking and letting go nobody
// else changes them, and the moments of letting go put all insertions in one order: the result is
// what one thread would get by inserting in that order, and any order gives the one triangulation
// that symbolic perturbation leaves.
//
// Why nobody waits for another for ever: a thread never waits for a cell. If a cell is held, it
// releases all of its own and puts its point off. Two threads that want each other's cells both put
// off, and one of them succeeds in the next round or, for the last few points, the one thread that
// is left.
//
// Example: points p and q whose cavities share a cell. The thread of p holds it first; the thread
// of q finds the mark, lets go, and inserts other points; in the next round q meets the cells that
// p has made.

/// Continues a triangulation that one thread has begun (`alone`). Each thread has a lane: a
/// CellInsertion of its own on the same cells.
template <unsigned K>
class InsertTogether {
 public:
  /// `spare`: unused cells to reserve in each round, beyond those it is expected to need.
  InsertTogether(const LiftedPoints& points, const Run& run, CellInsertion<K>& alone,
                 std::uint64_t spare = std::uint64_t{1} << 14)
      : s_(points), run_(run), alone_(alone), spare_(spare) {
    for (unsigned t = 0; t < run.threads; ++t)
      lanes_.push_back(std::make_unique<Lane>(points, run, alone.cells(), t));
  }

  /// Inserts points, given by their places in the order of insertion. `done`: the number of points
  /// inserted before. A round takes at most as many new points as have been inserted, because its
  /// cells are allocated before it begins. Points that a lane could not insert, because another
  /// lane held a cell or no cells remained, are retried in the next round. One thread inserts the
  /// last of them. Calls after_round(the number of points inserted), which may throw.
  template <class AfterRound = void (*)(std::uint32_t)>
  void insert(
      std::span<const std::uint32_t> places, std::uint32_t done,
      const AfterRound& after_round = [](std::uint32_t) {}) {
    alone_.store().clear_marks();
    std::vector<std::uint32_t> left;
    while (!places.empty() || left.size() > few) {
      const auto fresh = places.first(std::min<std::size_t>(places.size(), std::max(done, few)));
      places = places.subspan(fresh.size());
      const std::size_t before = left.size();
      left = round(left, fresh, done);
      if (fresh.empty() && left.size() == before) break;  // no progress: finish serially
      done += static_cast<std::uint32_t>(before + fresh.size() - left.size());
      after_round(done);
      run_.report("triangulate", double(done) / s_.count);
    }
    alone_.restart();
    for (const std::uint32_t p : left) alone_.insert(p);
  }

  LiftCounts counts() {
    LiftCounts sum;
    for (const auto& lane : lanes_) sum.add(lane->counts());
    return sum;
  }

 private:
  using Lane = CellInsertion<K, true>;
  /// One thread inserts up to this many last points, as every round marks all cells. Untested
  /// value.
  static constexpr std::uint32_t few = 64;
  /// Consecutive points that a lane takes at once: about 100 microseconds of work, the longest time
  /// that the other lanes wait at the end of a round.
  static constexpr std::uint32_t chunk = K == 2 || K == 3 ? 32 : K == 4 ? 4 : 1;

  /// Inserts these points with all lanes, `done` having been inserted before; returns those that
  /// were not inserted. Points are in the order of a curve, and a lane's chunks follow each other.
  std::vector<std::uint32_t> round(std::span<const std::uint32_t> again,
                                   std::span<const std::uint32_t> fresh, std::uint32_t done) {
    const std::size_t count = again.size() + fresh.size();
    alone_.share(count, done, spare_);
    std::atomic<bool> full{false};
    std::vector<std::vector<std::uint32_t>> left(lanes_.size());
    for (const auto& lane : lanes_) lane->restart();
    run_.each_in_lane(count, chunk, [&](unsigned t, std::uint64_t begin, std::uint64_t end) {
      for (std::uint64_t i = begin; i < end; ++i) {
        const std::uint32_t place = i < again.size() ? again[i] : fresh[i - again.size()];
        Inserted how = Inserted::full;
        if (!full.load(std::memory_order_relaxed)) how = lanes_[t]->insert(place);
        if (how == Inserted::busy || how == Inserted::full) left[t].push_back(place);
        if (how == Inserted::full) full = true;
      }
    });
    alone_.unshare();
    std::vector<std::uint32_t> all;
    for (std::size_t t = 0; t < lanes_.size(); ++t) {
      lanes_[t]->give_cells_back();
      all.insert(all.end(), left[t].begin(), left[t].end());
    }
    return all;
  }

  const LiftedPoints& s_;
  const Run& run_;
  CellInsertion<K>& alone_;
  std::uint64_t spare_;
  std::vector<std::unique_ptr<Lane>> lanes_;
};

}  // namespace cullhull::internal
