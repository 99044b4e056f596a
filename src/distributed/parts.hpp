// The points that the ranks contribute to the common hull, and how they are gathered along a
// binomial tree.
#pragma once

#include <cstdint>
#include <exception>
#include <functional>

#include "distributed/communicator.hpp"
#include "stream/numbered_points.hpp"

namespace cullhull::internal {

/// The points that may be extreme among `seen` points. All ranks' parts have the same dimension and
/// scalar type.
struct Part {
  NumberedPoints points;
  std::uint64_t seen = 0;
  std::uint64_t merged = 1;  ///< parts joined since the points were last reduced to extreme ones

  void append(const Part& other) {
    points.append(other.points);
    seen += other.seen;
    merged += other.merged;
  }
  /// Whether the part has fewer than half of the points seen. Only then is it worthwhile to reduce
  /// the points to the extreme ones.
  bool few() const { return points.size() < seen / 2; }
};

/// Called before that many bytes are allocated; throws if they exceed the budget.
using Room = std::function<void(std::uint64_t bytes)>;

/// Joins the parts of all ranks on `root`; the parts of the other ranks become empty. Each message
/// consists of a header, the receiver's answer whether it has room, and the ids and coordinates.
/// `reduce` is called on each rank that has received parts and sends its own on; `room` is called
/// before memory is allocated. If one of them throws on any rank, all ranks throw. `failure`: the
/// exception that prevented this rank from making its part, if any.
void gather(Communicator& ranks, int root, Part& part, const std::function<void(Part&)>& reduce,
            const Room& room, std::exception_ptr failure);

/// Replaces the part of every rank by a copy of that of `root`.
void broadcast(Communicator& ranks, int root, Part& part, const Room& room);

}  // namespace cullhull::internal
