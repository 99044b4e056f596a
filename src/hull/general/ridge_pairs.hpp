// Pairs the new facets of a cavity.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <vector>

#include "geometry/simplex.hpp"

namespace cullhull::internal {

/// Finds the neighbours among the facets that replace a cavity: every ridge through the new point
/// belongs to two of them. RidgeSums pairs them by a hash of the ridge. Keeps its memory.
class RidgePairs {
  using Id = std::uint32_t;

 public:
  /// Facet k of `count` has the d vertices[k d ...], of which number apex[k] is the new point.
  /// Writes to neighbours[k d + i] the facet across the ridge opposite to vertex i; 0 opposite to
  /// the point. turn(k, i) must find the same in another way, for ridges that share their hash. D:
  /// the dimension, 0 if it is known at run time only.
  template <unsigned D, class Turn>
  void find(unsigned dimension, const Id* vertices, const std::uint8_t* apex, std::size_t count,
            Id* neighbours, const Turn& turn) {
    const unsigned d = D > 0 ? D : dimension;
    if (count * d >= RidgeSums::max_entries) {
      for (std::size_t k = 0; k < count; ++k)
        for (unsigned i = 0; i < d; ++i) neighbours[k * d + i] = i != apex[k] ? turn(k, i) : 0;
      return;
    }
    // Small tables get twice as many slots, which reduces collisions and still fits L1.
    const auto bits = static_cast<unsigned>(std::bit_width(count * d)) + (count * d < 4096 ? 2 : 1);
    const std::uint32_t shift = 32 - bits, none_of_them = std::uint32_t{1} << bits;
    if (table_.size() <= none_of_them) table_.resize(std::size_t{none_of_them} + 1);
    std::memset(table_.data(), 0, (std::size_t{none_of_them} + 1) * sizeof(table_[0]));
    ridges_.resize(count * d);
    std::uint64_t* const table = table_.data();
    for (std::size_t k = 0; k < count; ++k) {
      const Id* v = vertices + k * d;
      Id* ridge = ridges_.data() + k * d;
      std::uint32_t whole = 0;
      for (unsigned i = 0; i < d; ++i) {
        std::uint32_t h = v[i] * 0x9E3779B1U;
        h ^= h >> 15;
        ridge[i] = h;
        whole += h;
      }
      for (unsigned i = 0; i < d; ++i) ridge[i] = ((whole - ridge[i]) * 0x85EBCA6BU) >> shift;
      ridge[apex[k]] = none_of_them;
      const std::uint64_t entry = RidgeSums::entry(static_cast<std::uint32_t>(k));
      for (unsigned i = 0; i < d; ++i) table[ridge[i]] += entry;
    }
    for (std::size_t k = 0; k < count; ++k) {
      Id* const local = neighbours + k * d;
      const Id* ridge = ridges_.data() + k * d;
      bool crowded = false;
      for (unsigned i = 0; i < d; ++i) {
        const std::uint64_t entry = table[ridge[i]];
        local[i] = RidgeSums::other(entry, static_cast<Id>(k));
        crowded |= !RidgeSums::is_pair(entry) & (i != apex[k]);
      }
      if (crowded)
        for (unsigned i = 0; i < d; ++i)
          if (!RidgeSums::is_pair(table[ridge[i]]) && i != apex[k]) local[i] = turn(k, i);
      local[apex[k]] = 0;
    }
  }

 private:
  std::vector<std::uint64_t> table_;
  std::vector<Id> ridges_;
};

}  // namespace cullhull::internal
