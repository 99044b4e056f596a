// Biased randomised insertion orders (Amenta, Choi, Rote 2003).
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>

namespace cullhull::internal {

/// Assigns points to random rounds. Each round is expected to have 2^growth_bits - 1 times as many
/// points as all rounds before it; up to `first_round` points form one round.
struct InsertionRounds {
  InsertionRounds(std::uint64_t points, std::uint64_t first_round, unsigned growth)
      : growth_bits(growth) {
    for (; points > first_round; points >>= growth_bits) ++count;
  }
  /// Returns the round of a point, from 0; `random`: its 64 random bits.
  unsigned round_of(std::uint64_t random) const {
    const unsigned from_last = static_cast<unsigned>(std::countr_zero(random)) / growth_bits;
    return count - 1 - std::min(from_last, count - 1);
  }

  unsigned growth_bits, count = 1;
};

}  // namespace cullhull::internal
