// Operations on the vertices of a simplex, for hulls and triangulations: sorting them with the sign
// of the permutation, and pairing the simplices that share a ridge.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>

#include "parallel/sort_few.hpp"

namespace cullhull::internal {

/// Sorts the ids of a simplex ascending; returns whether the permutation is odd. `along`: numbers
/// that move with the ids, for instance the neighbours opposite to them. `make_even`: if the
/// permutation is odd, the last two are swapped afterwards. N: `count` if it is a compile-time
/// constant, else 0. If N > 0, no branch depends on the ids, which usually are in random order; if
/// N = 0, `along` may be null.
template <unsigned N, bool make_even = false>
inline bool sort_simplex(std::uint32_t* ids, std::uint32_t* along, unsigned count) {
  bool odd = false;
  if constexpr (N != 0) {
    std::uint64_t packed[N];
    for (unsigned i = 0; i < N; ++i) packed[i] = std::uint64_t{ids[i]} << 32 | along[i];
    odd = sort_few<N>(packed);
    if constexpr (make_even)
      if (odd) std::swap(packed[N - 1], packed[N - 2]);
    for (unsigned i = 0; i < N; ++i) {
      ids[i] = static_cast<std::uint32_t>(packed[i] >> 32);
      along[i] = static_cast<std::uint32_t>(packed[i]);
    }
  } else {
    const auto swap = [&](unsigned i) {
      std::swap(ids[i], ids[i - 1]);
      if (along != nullptr) std::swap(along[i], along[i - 1]);
    };
    for (unsigned i = 1; i < count; ++i)
      for (unsigned j = i; j > 0 && ids[j] < ids[j - 1]; --j, odd = !odd) swap(j);
    if (make_even && odd) swap(count - 1);
  }
  return odd;
}

/// Writes the facet opposite to corner `slot` of a positively oriented cell to `facet`: its ids
/// ascending, the last two swapped if needed to orient it outward.
inline void outward_facet(std::span<const std::uint32_t> cell, unsigned slot,
                          std::uint32_t* facet) {
  const auto k = static_cast<unsigned>(cell.size()) - 1;
  for (unsigned i = 0, to = 0; i <= k; ++i)
    if (i != slot) facet[to++] = cell[i];
  // The boundary of a positive cell without corner j has the sign (-1)^j.
  const bool odd = sort_simplex<0>(facet, nullptr, k) != (slot % 2 == 1);
  if (odd && k > 1) std::swap(facet[k - 1], facet[k - 2]);
}

/// Pairs the two new simplices at each ridge of a cavity without comparing vertices. Each simplex
/// adds entry(its number) to the table slot given by a hash of the ridge's vertices. If is_pair()
/// is true for a slot, exactly two simplices have added to it, and they share a ridge, whatever the
/// hash function; other() then returns one from the other. Simplices in other slots must be found
/// in another way.
///
/// The upper 22 bits of a slot count the entries, the lower 42 bits sum the numbers. The sum of two
/// numbers has 33 bits. Fewer than max_entries numbers carry at most 2^10 into the count, so the
/// count never wraps around: it is 2 for two entries alone.
struct RidgeSums {
  static constexpr std::size_t max_entries = std::size_t{1} << 20;

  static constexpr std::uint64_t entry(std::uint32_t number) {
    return (std::uint64_t{1} << sum_bits) | number;
  }
  static constexpr bool is_pair(std::uint64_t slot) { return slot >> sum_bits == 2; }
  static constexpr std::uint32_t other(std::uint64_t slot, std::uint32_t number) {
    return static_cast<std::uint32_t>(slot & ((std::uint64_t{1} << sum_bits) - 1)) - number;
  }

 private:
  static constexpr unsigned sum_bits = 42;
};

}  // namespace cullhull::internal
