// The insertion order of the engine for d >= 4.
#pragma once

#include <cstdint>
#include <vector>

#include "exact/points/local_points.hpp"
#include "parallel/memory/raw_array.hpp"
#include "parallel/radix_sort.hpp"
#include "parallel/threads/run.hpp"

namespace cullhull::internal {

/// Orders points outermost first: by decreasing norm in the metric of their covariance, which makes
/// the engine create and delete few facets (on a ball 3 to 4 per final facet, in random order 6 to
/// 7). Points are taken in rounds, each half as large as all before it together; within a round
/// along a Hilbert curve, so that consecutive points are near one another. Points of equal norm
/// come in pseudo-random order. Between rounds the remaining points can be thinned before they are
/// sorted. Deterministic for any number of threads. Total time O(n d^2).
class NormOrder {
 public:
  /// Orders all points except `left_out`.
  NormOrder(const LocalPoints& points, std::vector<std::uint32_t> left_out, const Run& run);

  /// The number of points that no round has taken yet.
  std::uint32_t left() const { return count_ - taken_; }
  /// Returns one of them, k < left(), in no particular order.
  std::uint32_t left_at(std::uint32_t k) const { return items_[taken_ + k].id; }

  /// Appends the next rounds, `most` of them or all that are left, to `order`, and to `ends` where
  /// each ends there.
  void take_rounds(std::size_t most, std::vector<std::uint32_t>& order,
                   std::vector<std::uint32_t>& ends);

  /// Removes the remaining points at the positions k where dropped[k] is nonzero.
  void drop(const std::uint8_t* dropped);

 private:
  void compute_norms();
  void sort_outermost(std::uint32_t wanted);
  std::uint32_t select_outermost(std::uint32_t wanted);
  void sort(std::uint32_t begin, std::uint32_t end, unsigned bits);
  void arrange(std::uint32_t begin, std::uint32_t end);

  const LocalPoints& points_;
  const Run run_;
  RawArray<KeyedId> items_, scratch_;
  std::uint32_t count_ = 0;   ///< number of items, those taken included
  std::uint32_t taken_ = 0;   ///< number of items taken, from the front
  std::uint32_t sorted_ = 0;  ///< number of items at the front that are the outermost, in order
};

}  // namespace cullhull::internal
