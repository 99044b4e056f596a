// The data-parallel primitives for algorithms that run on more than one executor. Every executor
// gives the same answers, bit for bit: ties are broken by index or value, never by the order of
// work, and compaction is stable.
//
// Executors run small functors over plain pointers, marked CULLHULL_HD, so that the same text is a
// loop body on the host and a kernel body on a device. Memory that functors access comes from the
// executor (`Array`, `reserve`) and is copied by it (`fetch`, `upload`).
#pragma once

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <cstring>
#include <numeric>
#include <vector>

#include "parallel/host_device.hpp"
#include "parallel/memory/raw_array.hpp"
#include "parallel/threads/parallel.hpp"

namespace cullhull::internal {

struct Run;
inline constexpr std::uint32_t no_item = 0xFFFFFFFF;

// Why maxima make results independent of threads: the largest of some numbers does not depend on
// the order in which they are offered, and among equal values the lowest index is chosen
// afterwards. Distances are offered as the bits of a double that is not negative: as integers they
// have the same order. Example: 1.0 is 0x3ff0000000000000 and 1.5 is 0x3ff8000000000000.

/// The value that an item offers to a cell; 0 with the cell no_item for no offer.
struct Offer {
  std::uint32_t cell;
  std::uint64_t value;
};

/// How many items there are: `number`, or `number` times what stands in the executor's memory.
struct ItemCount {
  const std::uint32_t* there;
  std::uint32_t number;
  CULLHULL_HD std::uint32_t get() const { return there == nullptr ? number : *there * number; }
};

/// Bytes that an executor copies to the caller's memory.
struct Transfer {
  const void* from;
  void* to;
  std::size_t bytes;
};

/// Writes items that the caller knows into an executor's memory.
template <class T, unsigned N>
struct Put {
  T items[N];
  T* to;
  CULLHULL_HD void operator()(std::uint32_t i) const { to[i] = items[i]; }
};

/// A result of a reduction, which a device may still be working on.
template <class T>
struct Known {
  T value;
  T get() const { return value; }
};

/// Memory of an executor on the host. Contents are lost when it grows.
template <class T>
class HostArray {
 public:
  T* reserve(std::size_t count) {
    if (count > capacity_) {
      items_ = {};  // freed first, so that the two are never held at once
      capacity_ = 0;
      items_ = BigArray<T>(count);
      capacity_ = count;
    }
    return items_.get();
  }
  T* data() { return items_.get(); }
  const T* data() const { return items_.get(); }

 private:
  BigArray<T> items_;
  std::size_t capacity_ = 0;
};

/// Common to all executors on the host.
struct HostMemory {
  template <class T>
  using Array = HostArray<T>;
  /// Rows per step of a reduction: a block (12 KB in 3D, 32 KB in 8D) that ExtremesOfStep scans
  /// twice while it is in L1. Other values are untested.
  static constexpr std::uint32_t grain = 512;
  /// Whether to cut work finely even if some is then done twice.
  static constexpr bool many_threads = false;

  /// Returns room for `count` items, not initialised.
  template <class T>
  static T* reserve(Array<T>& array, std::size_t count) {
    return array.reserve(count);
  }
  template <class T>
  static void fetch(const T* from, std::size_t count, T* to) {
    std::copy_n(from, count, to);
  }
  /// The same for many items, where a device has its own way; with the threads of `run`.
  static void fetch_all(const std::vector<Transfer>& transfers, const Run&) {
    for (const Transfer& t : transfers)
      if (t.bytes != 0) std::memcpy(t.to, t.from, t.bytes);
  }
  /// The items of [0, count) by ascending key(i), stably, in `out`; only the `bits` low bits of
  /// keys may be set.
  template <class Key>
  static const std::uint32_t* sort(std::uint32_t count, const Key& key, unsigned /*bits*/,
                                   Array<std::uint32_t>& out) {
    std::uint32_t* const items = out.reserve(count);
    std::iota(items, items + count, 0U);
    std::sort(items, items + count, [&](std::uint32_t a, std::uint32_t b) {
      return key(a) != key(b) ? key(a) < key(b) : a < b;
    });
    return items;
  }
  template <class T>
  static void zero(T* items, std::size_t count) {
    std::fill_n(items, count, T{});
  }
  /// What primitives take and return as numbers of items: on a device one that may be still there.
  /// It converts to the number, which waits until the device has sent it.
  using Count = std::uint32_t;
  /// Sends the numbers that are still there: reading them does not wait for what is started later.
  static void send_counts() {}
  /// `factor` times a number; the most that it may be, and a lower bound of that; and the number
  /// for use in bodies.
  static Count times(Count count, std::uint32_t factor) { return count * factor; }
  static std::uint32_t most(Count count) { return count; }
  static Count at_most(Count count, std::uint32_t most) { return std::min(count, most); }
  static ItemCount items(Count count) { return {nullptr, count}; }
  /// How many rounds of an algorithm are started before the numbers of the one before are read. Of
  /// rounds that take no room, how many are started between two looks at a number, and how many of
  /// them after the look.
  static constexpr std::uint32_t rounds_ahead = 0, rounds_at_once = 1, rounds_after_look = 1;
  /// As many items, and fewer, are better listed than looked for among all.
  static constexpr std::uint32_t few_items = no_item;
};

/// What both executors on the host do by their for_each() and select().
template <class Executor>
class HostExecutor : public HostMemory {
 public:
  /// Calls body(i) for every i of [0, count) with keep(i), which no body may change for another i.
  template <class Keep, class Body>
  void for_each_where(std::uint32_t count, Keep&& keep, Body&& body) const {
    executor().for_each(count, [&](std::uint32_t i) {
      if (keep(i)) body(i);
    });
  }

  /// As reduce(), for a caller that starts other work before it needs the result.
  template <class T, class Map, class Combine>
  Known<T> begin_reduce(std::uint32_t count, T identity, Map&& map, Combine&& combine) const {
    return {executor().reduce(count, identity, map, combine)};
  }

  /// As select(), in any order of the k.
  template <class Keep, class Emit>
  std::uint32_t append(std::uint32_t count, Keep&& keep, Emit&& emit) const {
    return executor().select(count, keep, emit);
  }

  /// Rounds of two steps, from `first` to `last` or until a round has no items: items(round) of
  /// `steps` says how many it has, items_of(listed) in the first; then first(round, i) is called
  /// for each of them, and after all of these second(round, i), which may add items to the next
  /// round. Returns how many rounds had items.
  template <class Steps>
  std::uint32_t rounds(const Steps& steps, std::uint32_t first, std::uint32_t last,
                       std::uint32_t listed, const Control& control) const {
    std::uint32_t round = first, items = Steps::items_of(listed);
    for (; round <= last && items != 0; items = steps.items(++round)) {
      control.check();
      executor().for_each(items, [&](std::uint32_t i) { steps.first(round, i); });
      executor().for_each(items, [&](std::uint32_t i) { steps.second(round, i); });
    }
    return round - first;
  }

 private:
  const Executor& executor() const { return static_cast<const Executor&>(*this); }
};

/// The reference implementation: loops in order.
class SerialExecutor : public HostExecutor<SerialExecutor> {
 public:
  /// Calls body(i) for every i of [0, count).
  template <class Body>
  void for_each(std::uint32_t count, Body&& body) const {
    for (std::uint32_t i = 0; i < count; ++i) body(i);
  }

  /// Returns `identity`, map(0) ... map(count - 1), combined. `combine` must be associative and
  /// commutative without rounding, `identity` its neutral element. `map` is called once for each
  /// item.
  template <class T, class Map, class Combine>
  T reduce(std::uint32_t count, T identity, Map&& map, Combine&& combine) const {
    for (std::uint32_t i = 0; i < count; ++i) identity = combine(identity, map(i));
    return identity;
  }

  /// Stable compaction: calls emit(i, k) for the k-th i (from 0) with keep(i); returns the number
  /// of these. `keep` may be called twice for an item and must then give the same answer. An
  /// executor may also emit an item that is not kept, to the place of the next kept one or the one
  /// after the last: this avoids an unpredictable branch.
  template <class Keep, class Emit>
  std::uint32_t select(std::uint32_t count, Keep&& keep, Emit&& emit) const {
    std::uint32_t k = 0;
    for (std::uint32_t i = 0; i < count; ++i) {
      emit(i, k);
      k += static_cast<std::uint32_t>(keep(i));
    }
    return k;
  }

  /// Sets number[i] to the number of items kept among [0, i), then calls then(i), for every i of
  /// [0, count); returns the number of all that are kept. There must be room for count + 1 numbers.
  template <class Keep, class Then>
  std::uint32_t enumerate(std::uint32_t count, Keep&& keep, std::uint32_t* number,
                          Then&& then) const {
    std::uint32_t sum = 0;
    for (std::uint32_t i = 0; i < count; ++i) {
      number[i] = sum;
      sum += static_cast<std::uint32_t>(keep(i));
    }
    for_each(count, then);
    return sum;
  }

  /// Calls body(i), which returns an Offer, for every item; sets best[c] to the largest value
  /// offered to cell c of [0, cells), 0 if there is none. Returns the number of items without an
  /// offer (no_item). cells >= 1.
  template <class Body>
  std::uint32_t scatter_max(std::uint32_t count, std::uint32_t cells, Body&& body,
                            std::uint64_t* best) const {
    std::fill_n(best, cells, 0);
    std::uint32_t none = 0;
    for (std::uint32_t i = 0; i < count; ++i) {
      const Offer offer = body(i);
      none += static_cast<std::uint32_t>(offer.cell == no_item);
      std::uint64_t& b = best[std::min(offer.cell, cells - 1)];
      if (offer.value > b) b = offer.value;
    }
    return none;
  }

  /// For use in bodies: sets target = min(target, value), or max, atomically if bodies run
  /// concurrently.
  CULLHULL_HD static void lower(std::uint32_t& target, std::uint32_t value) {
    if (value < target) target = value;
  }
  CULLHULL_HD static void raise(std::uint64_t& target, std::uint64_t value) {
    if (value > target) target = value;
  }
  /// Likewise: raises a word, and returns whether it was lower.
  CULLHULL_HD static bool is_first(std::uint32_t& target, std::uint32_t value) {
    const bool lower = target < value;
    if (lower) target = value;
    return lower;
  }
  /// Likewise: adds n, and returns what was there before.
  CULLHULL_HD static std::uint32_t next(std::uint32_t& counter, std::uint32_t n) {
    return (counter += n) - n;
  }
};

/// Does the same on several threads.
class ThreadExecutor : public HostExecutor<ThreadExecutor> {
 public:
  explicit ThreadExecutor(unsigned threads) : threads_(threads) {}

  template <class Body>
  void for_each(std::uint32_t count, Body&& body) const {
    for_each_chunk(count, chunk, threads_,
                   [&](std::uint64_t, std::uint64_t begin, std::uint64_t end) {
      for (std::uint64_t i = begin; i < end; ++i) body(static_cast<std::uint32_t>(i));
    });
  }

  template <class T, class Map, class Combine>
  T reduce(std::uint32_t count, T identity, Map&& map, Combine&& combine) const {
    // An item may be a block of points, hence short chunks.
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
    const std::vector<std::uint32_t> offsets = kept_before_chunks(count, keep);
    for_each_chunk(count, chunk, threads_,
                   [&](std::uint64_t c, std::uint64_t begin, std::uint64_t end) {
      std::uint32_t k = offsets[c];
      for (std::uint64_t i = begin; i < end; ++i)
        if (keep(static_cast<std::uint32_t>(i))) emit(static_cast<std::uint32_t>(i), k++);
    });
    return offsets.back();
  }

  template <class Keep, class Then>
  std::uint32_t enumerate(std::uint32_t count, Keep&& keep, std::uint32_t* number,
                          Then&& then) const {
    const std::vector<std::uint32_t> offsets = kept_before_chunks(count, keep);
    for_each_chunk(count, chunk, threads_,
                   [&](std::uint64_t c, std::uint64_t begin, std::uint64_t end) {
      std::uint32_t k = offsets[c];
      for (std::uint64_t i = begin; i < end; ++i) {
        number[i] = k;
        k += static_cast<std::uint32_t>(keep(static_cast<std::uint32_t>(i)));
      }
    });
    for_each(count, then);
    return offsets.back();
  }

  template <class Body>
  std::uint32_t scatter_max(std::uint32_t count, std::uint32_t cells, Body&& body,
                            std::uint64_t* best) const {
    for_each(cells, [&](std::uint32_t c) { best[c] = 0; });
    std::atomic<std::uint32_t> none{0};
    for_each_chunk(count, chunk, threads_,
                   [&](std::uint64_t, std::uint64_t begin, std::uint64_t end) {
      std::uint32_t mine = 0;
      for (std::uint64_t i = begin; i < end; ++i) {
        const Offer offer = body(static_cast<std::uint32_t>(i));
        mine += static_cast<std::uint32_t>(offer.cell == no_item);
        raise(best[std::min(offer.cell, cells - 1)], offer.value);
      }
      none += mine;
    });
    return none;
  }

  static void lower(std::uint32_t& target, std::uint32_t v) {
    std::atomic_ref<std::uint32_t> t(target);
    std::uint32_t now = t.load(std::memory_order_relaxed);
    while (v < now && !t.compare_exchange_weak(now, v, std::memory_order_relaxed)) {
    }
  }

  static void raise(std::uint64_t& target, std::uint64_t v) {
    std::atomic_ref<std::uint64_t> t(target);
    std::uint64_t now = t.load(std::memory_order_relaxed);
    while (v > now && !t.compare_exchange_weak(now, v, std::memory_order_relaxed)) {
    }
  }

  static bool is_first(std::uint32_t& target, std::uint32_t v) {
    std::atomic_ref<std::uint32_t> t(target);
    std::uint32_t now = t.load(std::memory_order_relaxed);
    while (v > now)
      if (t.compare_exchange_weak(now, v, std::memory_order_relaxed)) return true;
    return false;
  }

  static std::uint32_t next(std::uint32_t& counter, std::uint32_t n) {
    return std::atomic_ref<std::uint32_t>(counter).fetch_add(n, std::memory_order_relaxed);
  }

 private:
  static constexpr std::uint64_t chunk = 4096;  // tens of us of work

  /// Returns for each chunk the number of items kept before it, and last their total.
  template <class Keep>
  std::vector<std::uint32_t> kept_before_chunks(std::uint32_t count, Keep&& keep) const {
    std::vector<std::uint32_t> offsets(chunk_count(count, chunk) + 1, 0);
    for_each_chunk(count, chunk, threads_,
                   [&](std::uint64_t c, std::uint64_t begin, std::uint64_t end) {
      std::uint32_t kept = 0;
      for (std::uint64_t i = begin; i < end; ++i)
        kept += keep(static_cast<std::uint32_t>(i)) ? 1 : 0;
      offsets[c + 1] = kept;
    });
    for (std::size_t c = 1; c < offsets.size(); ++c) offsets[c] += offsets[c - 1];
    return offsets;
  }

  unsigned threads_;
};

}  // namespace cullhull::internal
