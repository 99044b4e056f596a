// The order in which the engine for d >= 4 takes its points.
#pragma once

#include <cstdint>
#include <vector>

#include "geometry/local_points.hpp"
#include "parallel/control.hpp"
#include "parallel/raw_array.hpp"

namespace cullhull::internal {

/// Outermost first: by decreasing norm, the points' covariance taken as the unit, which makes few
/// facets that do not last (on a ball 3 to 4 for each that does, in random order 6 to 7). Taken in
/// rounds, each half as large as all before it together, and within a round along a Hilbert curve,
/// so that neighbours in the order are neighbours in space. Points of equal norm come in
/// pseudo-random order. What is left can be thinned between rounds, before it is sorted.
/// Deterministic for any number of threads. Time O(n d^2) in all.
class NormOrder {
 public:
  /// Of all points but those of `left_out`.
  NormOrder(const LocalPoints& points, std::vector<std::uint32_t> left_out, unsigned threads,
            const Control& control);

  /// Points that no round has taken yet.
  std::uint32_t left() const { return count_ - taken_; }
  /// One of them, k < left(): the outermost are not always the first.
  std::uint32_t left_at(std::uint32_t k) const { return items_[taken_ + k].id; }

  /// Appends the next round to `order`.
  void take_round(std::vector<std::uint32_t>& order);

  /// Leaves of what is left those at the places k where dropped[k] is 0.
  void drop(const std::uint8_t* dropped);

 private:
  struct Keyed {
    std::uint32_t key, id;
  };

  void compute_norms();
  void sort_outermost(std::uint32_t wanted);
  void arrange(Keyed* begin, std::uint32_t size);

  const LocalPoints& points_;
  const unsigned threads_;
  const Control& control_;
  RawArray<Keyed> items_, scratch_;
  std::uint32_t count_ = 0;   ///< items, those taken included
  std::uint32_t taken_ = 0;   ///< from the front
  std::uint32_t sorted_ = 0;  ///< from the front: they are the outermost, in order
};

}  // namespace cullhull::internal
