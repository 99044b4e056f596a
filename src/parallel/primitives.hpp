// The data-parallel primitives that algorithms with more than one executor are written over. Every
// executor gives the same answers, bit for bit: ties go to the lowest index, partial results are
// combined in index order, compaction is stable.
#pragma once

#include <atomic>
#include <bit>
#include <cstdint>
#include <vector>

#include "parallel/parallel.hpp"

namespace cullhull::internal {

inline constexpr std::uint32_t no_item = 0xFFFFFFFF;

/// Sets a flag that other threads may set to the same value at the same time.
inline void mark(std::uint32_t& flag) {
  std::atomic_ref<std::uint32_t>(flag).store(1, std::memory_order_relaxed);
}

/// The reference: loops in order.
class SerialExecutor {
 public:
  /// body(i) for every i of [0, count).
  template <class Body>
  void for_each(std::uint32_t count, Body&& body) const {
    for (std::uint32_t i = 0; i < count; ++i) body(i);
  }

  /// combine(... combine(combine(identity, map(0)), map(1)) ..., map(count - 1)), where `combine`
  /// is associative and `identity` is neutral.
  template <class T, class Map, class Combine>
  T reduce(std::uint32_t count, T identity, Map&& map, Combine&& combine) const {
    for (std::uint32_t i = 0; i < count; ++i) identity = combine(identity, map(i));
    return identity;
  }

  /// Stable compaction: emit(i, k) for the k-th i (from 0) with keep(i); returns how many there
  /// are. `keep` may be asked twice and must answer alike. An executor may emit an item that is not
  /// kept to a place k < count that is overwritten or beyond the end: it spares an unpredictable
  /// branch.
  template <class Keep, class Emit>
  std::uint32_t select(std::uint32_t count, Keep&& keep, Emit&& emit) const {
    std::uint32_t k = 0;
    for (std::uint32_t i = 0; i < count; ++i) {
      emit(i, k);
      k += static_cast<std::uint32_t>(keep(i));
    }
    return k;
  }

  /// values[i] becomes the sum of values[0 .. i); returns the sum of all.
  std::uint32_t exclusive_scan(std::uint32_t* values, std::uint32_t count) const {
    std::uint32_t sum = 0;
    for (std::uint32_t i = 0; i < count; ++i) {
      const std::uint32_t v = values[i];
      values[i] = sum;
      sum += v;
    }
    return sum;
  }

  /// winner[s] becomes the item i of segment(i) == s with the largest value(i) >= 0, the lowest i
  /// of equal ones; no_item for a segment without items. Items need not be grouped.
  template <class Segment, class Value>
  void segmented_argmax(std::uint32_t count, std::uint32_t segments, Segment&& segment,
                        Value&& value, std::uint32_t* winner) {
    best_.assign(segments, -1.0);
    for (std::uint32_t s = 0; s < segments; ++s) winner[s] = no_item;
    for (std::uint32_t i = 0; i < count; ++i) {
      const std::uint32_t s = segment(i);
      const double v = value(i);
      if (v > best_[s]) {
        best_[s] = v;
        winner[s] = i;
      }
    }
  }

 private:
  std::vector<double> best_;
};

/// The same on the threads of oneTBB.
class TbbExecutor {
 public:
  explicit TbbExecutor(unsigned threads) : threads_(threads) {}

  template <class Body>
  void for_each(std::uint32_t count, Body&& body) const {
    for_each_chunk(count, chunk, threads_,
                   [&](std::uint64_t, std::uint64_t begin, std::uint64_t end) {
                     for (std::uint64_t i = begin; i < end; ++i)
                       body(static_cast<std::uint32_t>(i));
                   });
  }

  template <class T, class Map, class Combine>
  T reduce(std::uint32_t count, T identity, Map&& map, Combine&& combine) const {
    // An item may be a block of points: short chunks.
    constexpr std::uint64_t items = 64;
    std::vector<T> partial(chunk_count(count, items), identity);
    for_each_chunk(count, items, threads_,
                   [&](std::uint64_t c, std::uint64_t begin, std::uint64_t end) {
                     T sum = identity;
                     for (std::uint64_t i = begin; i < end; ++i)
                       sum = combine(sum, map(static_cast<std::uint32_t>(i)));
                     partial[c] = sum;
                   });
    for (const T& p : partial) identity = combine(identity, p);
    return identity;
  }

  template <class Keep, class Emit>
  std::uint32_t select(std::uint32_t count, Keep&& keep, Emit&& emit) const {
    std::vector<std::uint32_t> offsets(chunk_count(count, chunk));
    for_each_chunk(count, chunk, threads_,
                   [&](std::uint64_t c, std::uint64_t begin, std::uint64_t end) {
                     std::uint32_t kept = 0;
                     for (std::uint64_t i = begin; i < end; ++i)
                       kept += keep(static_cast<std::uint32_t>(i)) ? 1 : 0;
                     offsets[c] = kept;
                   });
    const std::uint32_t total =
        serial_.exclusive_scan(offsets.data(), static_cast<std::uint32_t>(offsets.size()));
    for_each_chunk(count, chunk, threads_,
                   [&](std::uint64_t c, std::uint64_t begin, std::uint64_t end) {
                     std::uint32_t k = offsets[c];
                     for (std::uint64_t i = begin; i < end; ++i)
                       if (keep(static_cast<std::uint32_t>(i)))
                         emit(static_cast<std::uint32_t>(i), k++);
                   });
    return total;
  }

  std::uint32_t exclusive_scan(std::uint32_t* values, std::uint32_t count) const {
    std::vector<std::uint32_t> offsets(chunk_count(count, chunk));
    for_each_chunk(count, chunk, threads_,
                   [&](std::uint64_t c, std::uint64_t begin, std::uint64_t end) {
                     std::uint32_t sum = 0;
                     for (std::uint64_t i = begin; i < end; ++i) sum += values[i];
                     offsets[c] = sum;
                   });
    const std::uint32_t total =
        serial_.exclusive_scan(offsets.data(), static_cast<std::uint32_t>(offsets.size()));
    for_each_chunk(count, chunk, threads_,
                   [&](std::uint64_t c, std::uint64_t begin, std::uint64_t end) {
                     std::uint32_t sum = offsets[c];
                     for (std::uint64_t i = begin; i < end; ++i) {
                       const std::uint32_t v = values[i];
                       values[i] = sum;
                       sum += v;
                     }
                   });
    return total;
  }

  // Values that are not negative are ordered as their bits are: first the largest, then the lowest
  // item that has it. Both are independent of the order of the threads.
  template <class Segment, class Value>
  void segmented_argmax(std::uint32_t count, std::uint32_t segments, Segment&& segment,
                        Value&& value, std::uint32_t* winner) {
    best_.assign(segments, 0);
    for (std::uint32_t s = 0; s < segments; ++s) winner[s] = no_item;
    const auto bits = [&](std::uint32_t i) { return std::bit_cast<std::uint64_t>(value(i) + 0.0); };
    for_each(count, [&](std::uint32_t i) { raise(best_[segment(i)], bits(i)); });
    for_each(count, [&](std::uint32_t i) {
      if (bits(i) == best_[segment(i)]) lower(winner[segment(i)], i);
    });
  }

 private:
  static constexpr std::uint64_t chunk = 4096;

  static void raise(std::uint64_t& target, std::uint64_t v) {
    std::atomic_ref<std::uint64_t> t(target);
    std::uint64_t now = t.load(std::memory_order_relaxed);
    while (v > now && !t.compare_exchange_weak(now, v, std::memory_order_relaxed)) {
    }
  }
  static void lower(std::uint32_t& target, std::uint32_t v) {
    std::atomic_ref<std::uint32_t> t(target);
    std::uint32_t now = t.load(std::memory_order_relaxed);
    while (v < now && !t.compare_exchange_weak(now, v, std::memory_order_relaxed)) {
    }
  }

  unsigned threads_;
  SerialExecutor serial_;
  std::vector<std::uint64_t> best_;
};

}  // namespace cullhull::internal
