// The points that ranks contribute to the hull of all, and their gathering up a binomial tree.
#pragma once

#include <cstdint>
#include <exception>
#include <functional>

#include "distributed/communicator.hpp"
#include "stream/numbered_points.hpp"

namespace cullhull::internal::inline distributed {

/// Points that may be extreme, of `seen` points. Dimension and scalar type are those of all ranks.
struct Part {
  NumberedPoints points;
  std::uint64_t seen = 0;
  std::uint64_t merged = 1;  ///< number of parts joined since extreme points were found

  void append(const Part& other) {
    points.append(other.points);
    seen += other.seen;
    merged += other.merged;
  }
  /// Whether it has so few of its points that reducing them to the extreme ones pays.
  bool few() const { return points.size() < seen / 2; }
};

/// May throw before so many bytes are allocated.
using Room = std::function<void(std::uint64_t bytes)>;

/// Collects on `root` the parts of all ranks, end to end; the others keep nothing. Messages between
/// two ranks: the header, whether there is room, then ids and coordinates. `reduce` is called on
/// each rank that has received parts and sends on, `room` before memory is allocated; where one of
/// them fails on any rank, all throw. `failure`: of this rank's part, if it has none.
void gather(Communicator& ranks, int root, Part& part, const std::function<void(Part&)>& reduce,
            const Room& room, std::exception_ptr failure);

/// Overwrites the part of every rank by that of `root`.
void broadcast(Communicator& ranks, int root, Part& part, const Room& room);

}  // namespace cullhull::internal::inline distributed
