// Ranges of items for threads that keep to neighbouring items: each thread works from the front of
// a range of its own, and takes from the back of others' when it is done.
#pragma once

#include <algorithm>
#include <cstdint>
#include <mutex>
#include <vector>

#include "parallel/threads/run.hpp"

namespace cullhull::internal {

/// The items [0, count) in a stretch for each of some lanes. Items are in the order of a curve,
/// say, so that neighbours share data: a lane keeps its neighbourhood in the cache, and a thief
/// takes what its owner reaches last. (Chunks of run_chunks are taken from the front by all: a
/// thief works beside the owner.)
class Stretches {
 public:
  Stretches(std::uint64_t count, unsigned lanes, std::uint32_t chunk)
      : chunk_(chunk), stretches_(lanes) {
    for (unsigned k = 0; k < lanes; ++k) {
      stretches_[k].begin = static_cast<std::uint32_t>(count * k / lanes);
      stretches_[k].end = static_cast<std::uint32_t>(count * (k + 1) / lanes);
    }
  }

  /// Calls body(begin, end) for chunks of items until none are left, first for those of the lane's
  /// own stretch.
  template <class Body>
  void work(std::uint64_t lane, const Body& body) {
    const std::size_t lanes = stretches_.size(), reach = spans::counting() ? 1 : lanes;
    std::uint32_t begin = 0, end = 0;
    for (std::size_t k = 0; k < reach; ++k)
      while (take(stretches_[(lane + k) % lanes], k == 0, begin, end)) body(begin, end);
  }

 private:
  struct alignas(64) Stretch {
    std::mutex mutex;
    std::uint32_t begin = 0, end = 0;
  };

  bool take(Stretch& from, bool front, std::uint32_t& begin, std::uint32_t& end) const {
    const std::lock_guard lock(from.mutex);
    const std::uint32_t count = std::min(chunk_, from.end - from.begin);
    begin = front ? from.begin : from.end - count;
    end = begin + count;
    (front ? from.begin : from.end) = front ? end : begin;
    return count > 0;
  }

  const std::uint32_t chunk_;
  std::vector<Stretch> stretches_;
};

}  // namespace cullhull::internal
