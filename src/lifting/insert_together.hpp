// Several threads insert points into one triangulation, each holding the cells it looks at. Which
// of them comes first does not matter: ties are broken by a perturbation, so there is one result.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <memory>
#include <vector>

#include "lifting/cell_insertion.hpp"
#include "lifting/lifted_points.hpp"
#include "parallel/run.hpp"

namespace cullhull::internal {

/// Of one insertion and the lanes, one a thread, that insert into the same cells.
template <unsigned K>
class InsertTogether {
 public:
  /// `spare`: for so many cells there is room besides those that a round is expected to take.
  InsertTogether(const LiftedPoints& points, const Run& run, CellInsertion<K>& alone,
                 std::uint64_t spare = std::uint64_t{1} << 14)
      : s_(points), run_(run), alone_(alone), spare_(spare) {
    for (unsigned t = 0; t < run.threads; ++t)
      lanes_.push_back(std::make_unique<Lane>(points, run, alone.cells(), t));
  }

  /// Places, in the order of insertion; `done`: how many points there are before them. Round by
  /// round, each of as many points as there are already, as for that many there must be room; what
  /// lanes leave to be done comes in the next, and the last of it alone.
  void insert(std::vector<std::uint32_t> places, std::uint32_t done) {
    std::vector<std::uint32_t> left;
    std::size_t next = 0;
    while (next < places.size() || left.size() > few) {
      const std::size_t end = std::min<std::size_t>(places.size(), next + std::max(done, few));
      const std::size_t begin = next - std::min(next, left.size());
      std::copy(left.begin(), left.end(), places.begin() + static_cast<std::ptrdiff_t>(begin));
      const std::size_t before = left.size();
      left = round(places.data() + begin, end - begin);
      if (next == end && left.size() == before) break;  // to no avail
      done += static_cast<std::uint32_t>(end - begin - left.size());
      next = end;
      run_.report("triangulate", double(done) / s_.count);
    }
    alone_.rest();
    for (const std::uint32_t p : left) alone_.insert(p);
  }

  LiftCounts counts() {
    LiftCounts sum;
    for (const auto& lane : lanes_) sum.add(lane->counts());
    return sum;
  }

 private:
  using Lane = CellInsertion<K, true>;
  static constexpr std::uint32_t few = 64;    // points that one thread does alone; a guess
  static constexpr std::uint64_t chunk = 32;  // neighbours along the curve, one lane's

  /// What was not inserted.
  std::vector<std::uint32_t> round(const std::uint32_t* places, std::size_t count) {
    alone_.share(spare_);
    const std::uint64_t chunks = (count + chunk - 1) / chunk, lanes = lanes_.size();
    std::atomic<std::uint64_t> next{0};
    std::atomic<bool> full{false};
    std::vector<std::vector<std::uint32_t>> left(lanes);
    for (const auto& lane : lanes_) lane->rest();
    run_.each_item(lanes, [&](std::uint64_t t) {
      for (std::uint64_t i = next++; i < chunks; i = next++) {
        // Lanes that take chunks by turns are far from one another.
        const std::uint64_t c = spread(i, chunks, lanes);
        const std::uint64_t end = std::min<std::uint64_t>(count, (c + 1) * chunk);
        for (std::uint64_t j = c * chunk; j < end; ++j) {
          if (full.load(std::memory_order_relaxed)) {
            left[t].push_back(places[j]);
            continue;
          }
          const Inserted how = lanes_[t]->insert(places[j]);
          if (how == Inserted::busy || how == Inserted::full) left[t].push_back(places[j]);
          if (how == Inserted::full) full = true;
        }
      }
    });
    alone_.unshare();
    std::vector<std::uint32_t> all;
    for (std::uint64_t t = 0; t < lanes; ++t) {
      lanes_[t]->give_cells_back();
      all.insert(all.end(), left[t].begin(), left[t].end());
    }
    return all;
  }

  /// Item i of a table of chunks with a row a lane, column by column.
  static std::uint64_t spread(std::uint64_t i, std::uint64_t chunks, std::uint64_t lanes) {
    const std::uint64_t column = i / lanes, row = i % lanes;
    const std::uint64_t columns = chunks / lanes, longer = chunks % lanes;
    return row * columns + std::min(row, longer) + column;
  }

  const LiftedPoints& s_;
  const Run& run_;
  CellInsertion<K>& alone_;
  std::uint64_t spare_;
  std::vector<std::unique_ptr<Lane>> lanes_;
};

}  // namespace cullhull::internal
