// Several threads insert points into one triangulation; each holds the cells it examines. The
// result does not depend on the order of insertion: a symbolic perturbation breaks ties, so that
// there is only one triangulation.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <memory>
#include <mutex>
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
      std::vector<std::uint32_t> places, std::uint32_t done,
      const AfterRound& after_round = [](std::uint32_t) {}) {
    std::vector<std::uint32_t> left;
    std::size_t next = 0;
    while (next < places.size() || left.size() > few) {
      const std::size_t end = std::min<std::size_t>(places.size(), next + std::max(done, few));
      const std::size_t begin = next - std::min(next, left.size());
      std::copy(left.begin(), left.end(), places.begin() + static_cast<std::ptrdiff_t>(begin));
      const std::size_t before = left.size();
      left = round(places.data() + begin, end - begin);
      if (next == end && left.size() == before) break;  // no progress: finish serially
      done += static_cast<std::uint32_t>(end - begin - left.size());
      next = end;
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

  // Both ends are one 64-bit word, so taking from either end is one compare-and-swap, and no point
  // can be taken twice. Example: [10, 100): the lane takes 32 and leaves [42, 100); a thief takes
  // the last 32 and leaves [42, 68). Points are in the order of a curve, so the lane keeps its
  // neighbourhood in the cache and a thief takes what is farthest from it.

  /// A lane's range of points. The lane takes from the front; other lanes steal from the back.
  struct Stretch {
    std::mutex mutex;
    std::uint32_t begin = 0, end = 0;

    /// Takes the points [first, last), at most a chunk; false if none are left.
    bool take(bool front, std::uint32_t& first, std::uint32_t& last) {
      const std::lock_guard lock(mutex);
      const std::uint32_t count = std::min(chunk, end - begin);
      first = front ? begin : end - count;
      last = first + count;
      (front ? begin : end) = front ? last : first;
      return count > 0;
    }
  };

  /// Inserts places[0, count) with all lanes; returns those that were not inserted.
  std::vector<std::uint32_t> round(const std::uint32_t* places, std::size_t count) {
    alone_.share(spare_);
    const std::size_t lanes = lanes_.size();
    std::vector<Stretch> stretches(lanes);
    for (std::size_t t = 0; t < lanes; ++t) {
      stretches[t].begin = static_cast<std::uint32_t>(count * t / lanes);
      stretches[t].end = static_cast<std::uint32_t>(count * (t + 1) / lanes);
    }
    std::atomic<bool> full{false};
    std::vector<std::vector<std::uint32_t>> left(lanes);
    for (const auto& lane : lanes_) lane->restart();
    run_.each_item(lanes, [&](std::uint64_t t) {
      const auto take = [&](std::uint32_t place) {
        Inserted how = Inserted::full;
        if (!full.load(std::memory_order_relaxed)) how = lanes_[t]->insert(place);
        if (how == Inserted::busy || how == Inserted::full) left[t].push_back(place);
        if (how == Inserted::full) full = true;
      };
      std::uint32_t begin = 0, end = 0;
      while (stretches[t].take(true, begin, end))
        for (std::uint32_t i = begin; i < end; ++i) take(places[i]);
      // Steal from the back of the other lanes' ranges, which their owners reach last.
      const std::size_t reach = spans::counting() ? 1 : lanes;
      for (std::size_t other = 1; other < reach; ++other)
        while (stretches[(t + other) % lanes].take(false, begin, end))
          for (std::uint32_t i = end; i > begin; --i) take(places[i - 1]);
    });
    alone_.unshare();
    std::vector<std::uint32_t> all;
    for (std::size_t t = 0; t < lanes; ++t) {
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
