// What the points of some ranks contribute to the hull of all, and its way up a binomial tree.
#pragma once

#include <cstdint>
#include <exception>
#include <functional>

#include "distributed/communicator.hpp"
#include "stream/numbered_points.hpp"

namespace cullhull::internal {

/// Points that may be extreme, of `seen` points. Dimension and scalar type are those of all ranks.
struct Part {
  NumberedPoints points;
  std::uint64_t seen = 0;
  std::uint64_t merged = 1;  ///< parts in it since extreme points were found

  void append(const Part& other) {
    points.append(other.points);
    seen += other.seen;
    merged += other.merged;
  }
  /// Whether it holds so few of its points that finding the extreme ones among them pays.
  bool few() const { return points.size() < seen / 2; }
};

/// May throw before so many bytes are taken in.
using Room = std::function<void(std::uint64_t bytes)>;

/// Leaves on `root` the parts of all ranks, end to end, and nothing on the others. Between two
/// ranks: what is there, whether there is room for it, then ids and coordinates. `reduce` is called
/// on each rank that has taken in others' parts and sends on, `room` before memory is taken; where
/// one of them fails on any rank, all throw. `failure`: of this rank's part, if there is none.
void gather(Communicator& ranks, int root, Part& part, const std::function<void(Part&)>& reduce,
            const Room& room, std::exception_ptr failure);

/// Makes the part of `root` that of all ranks.
void broadcast(Communicator& ranks, int root, Part& part, const Room& room);

}  // namespace cullhull::internal
