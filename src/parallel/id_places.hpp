// Places of ids in an ascending list.
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>
#include <vector>

#include "parallel/threads/run.hpp"

namespace cullhull::internal {

/// Finds an id's place in an ascending list, which must stay as it is, in constant time where the
/// ids are spread evenly: a binary search among those of a bucket of ids. (Searches in the whole
/// list took a seventh of a tracker's frame of 10,000 points.)
class IdPlaces {
 public:
  IdPlaces() = default;
  IdPlaces(const std::vector<std::uint64_t>& ids, const Run& run)
      : ids_(&ids),
        shift_(static_cast<unsigned>(std::bit_width(ids.back() / ids.size()))),
        first_((ids.back() >> shift_) + 2) {
    // The buckets behind that of the id before, up to the id's own, begin with it.
    run.each(ids.size(), light_grain, [&](std::uint64_t begin, std::uint64_t end) {
      std::uint64_t bucket = begin == 0 ? 0 : (ids[begin - 1] >> shift_) + 1;
      for (std::uint64_t i = begin; i < end; ++i)
        for (; bucket <= ids[i] >> shift_; ++bucket) first_[bucket] = static_cast<std::uint32_t>(i);
    });
    first_.back() = static_cast<std::uint32_t>(ids.size());
  }
  /// The length of the list if it does not have the id.
  std::uint32_t operator()(std::uint64_t id) const {
    const std::uint64_t bucket = id >> shift_;
    if (bucket + 1 >= first_.size()) return static_cast<std::uint32_t>(ids_->size());
    const auto begin = ids_->begin() + first_[bucket], end = ids_->begin() + first_[bucket + 1];
    const auto at = std::lower_bound(begin, end, id);
    return static_cast<std::uint32_t>((at != end && *at == id ? at : ids_->end()) - ids_->begin());
  }

 private:
  const std::vector<std::uint64_t>* ids_ = nullptr;
  unsigned shift_ = 0;
  std::vector<std::uint32_t> first_;  ///< of each bucket of ids the place of its first
};

}  // namespace cullhull::internal
