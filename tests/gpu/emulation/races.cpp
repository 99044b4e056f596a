#include "races.hpp"

#include <sys/mman.h>

#include <algorithm>
#include <cstring>
#include <string>

#include "block.hpp"
#include "emulation.hpp"

namespace emulation {
namespace {

constexpr unsigned warp_lanes = 32;

/// Threads that accessed an address, in a number: one thread, or several of a warp, a block or a
/// grid. Below it the block (its low bits) and the thread.
enum Scope : std::uint32_t { thread, warp, block, grid };
constexpr unsigned scope_shift = 30, block_shift = 10;
constexpr std::uint32_t atomically = 1U << 29, thread_bits = (1U << block_shift) - 1,
                        block_bits = atomically - 1 - thread_bits;

Scope scope_of(std::uint32_t who) { return static_cast<Scope>(who >> scope_shift); }

/// The latest accesses that nothing has ordered among one another.
struct Accesses {
  std::uint32_t tick, who;
};
struct Cell {
  Accesses writes, reads;
};

/// Cells for the words of a range of addresses, and for accesses of one or two bytes.
struct Shadow {
  void cover(std::size_t addresses) {
    words = map(addresses / 4);
    bytes = map(addresses);
  }
  static Cell* map(std::size_t cells) {
    void* memory = mmap(nullptr, cells * sizeof(Cell), PROT_READ | PROT_WRITE,
                        MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
    if (memory == MAP_FAILED) violation("no addresses are left for the record of accesses");
    return static_cast<Cell*>(memory);
  }
  Cell *words = nullptr, *bytes = nullptr;
};

constexpr std::size_t most_shared = std::size_t{1} << 20;  // addresses, most of them never used

struct Record {
  char* arena = nullptr;
  Shadow of_device, of_shared;
  unsigned char* shared = nullptr;
  std::size_t shared_bytes = 0;

  // Each is the tick since which accesses count.
  std::uint32_t now = 1, launch = 1, block = 1, barrier = 1;
  std::uint32_t warps[1024 / warp_lanes] = {};
  std::uint32_t blocks = 0;  ///< that ran in this launch
  std::uint32_t me = 0, my_warp_since = 1;
  std::uint64_t until_switch = 0;

  // A write to an address that another thread wrote: must leave its bytes as they are.
  const void* repeated = nullptr;
  std::size_t repeated_bytes = 0;
  unsigned char repeated_value[8] = {};

  /// Reserves the addresses, which needs to be done once.
  void reserve() {
    if (arena != nullptr) return;
    void* memory = mmap(nullptr, device_arena_bytes, PROT_NONE,
                        MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
    if (memory == MAP_FAILED) violation("no addresses are left for device memory");
    of_device.cover(device_arena_bytes);
    of_shared.cover(most_shared);
    arena = static_cast<char*>(memory);
  }
};

// Initialised by the compiler: every access begins here.
constinit Record the_record;
constinit thread_local bool in_kernel = false;

/// Threads that take turns before accesses: in some blocks often, in some seldom, in half never,
/// so that the turns at barriers alone occur, too.
std::uint64_t next_switch(bool first) {
  static std::uint64_t gap = 0;
  if (first) {
    const std::uint64_t choice = random64() % 8;
    gap = choice == 0 ? 4 : choice < 4 ? 64 : 0;
  }
  return gap == 0 ? ~std::uint64_t{0} : 1 + random64() % gap;
}

/// Whether accesses are ordered before the running thread's next one.
inline bool ordered(const Record& r, const Accesses& a, std::uint32_t since) {
  if (a.tick < since) return true;
  const Scope scope = scope_of(a.who);
  if (scope == grid || ((a.who ^ r.me) & block_bits) != 0) return false;
  if (a.tick < r.barrier) return true;
  const std::uint32_t apart = (a.who ^ r.me) & thread_bits;
  if (scope == block || apart >= warp_lanes) return false;
  if (a.tick < r.my_warp_since) return true;
  return scope == thread && apart == 0;
}

inline Accesses joined(const Record& r, const Accesses& a, std::uint32_t since) {
  if (ordered(r, a, since)) return {r.now, r.me};
  const std::uint32_t apart = a.who ^ r.me;
  Scope scope = (apart & block_bits) != 0                 ? grid
                : (apart & thread_bits) / warp_lanes != 0 ? block
                : (apart & thread_bits) != 0              ? warp
                                                          : thread;
  if (scope_of(a.who) > scope) scope = scope_of(a.who);
  return {r.now, r.me | std::uint32_t{scope} << scope_shift};
}

enum class Kind { read, volatile_read, write, atomic };

[[noreturn]] void race(const char* what, const Accesses& with) {
  violation(std::string(what) + " thread " + std::to_string(with.who & thread_bits) +
            " races with it: nothing orders the two");
}

/// A record of an access to a cell. True: another thread wrote there, which is allowed where this
/// write does not change the value.
[[gnu::always_inline]] inline bool touch(Record& r, Cell& cell, Kind kind, std::uint32_t since) {
  const bool by_atomic = (cell.writes.who & atomically) != 0;
  const bool clear = ordered(r, cell.writes, since);
  switch (kind) {
    case Kind::read:
      if (!clear) race("a read after a write:", cell.writes);
      cell.reads = joined(r, cell.reads, since);
      return false;
    case Kind::volatile_read:
      if (!clear && !by_atomic) race("a volatile read after a plain write:", cell.writes);
      return false;
    case Kind::write:
      if (!clear && by_atomic) race("a plain write after an atomic operation:", cell.writes);
      if (!ordered(r, cell.reads, since)) race("a write after a read:", cell.reads);
      cell.writes = joined(r, cell.writes, since);
      return !clear;
    case Kind::atomic:
      break;
  }
  if (!clear && !by_atomic) race("an atomic operation after a plain write:", cell.writes);
  if (!ordered(r, cell.reads, since)) race("an atomic operation after a read:", cell.reads);
  cell.writes = joined(r, cell.writes, since);
  cell.writes.who |= atomically;
  return false;
}

[[gnu::noinline]] void check_repeated(Record& r) {
  const bool same = std::memcmp(r.repeated, r.repeated_value, r.repeated_bytes) == 0;
  r.repeated = nullptr;  // first: violation() may be code that reports accesses, and so come here
  if (!same) violation("threads write different values to one address: nothing orders them");
}

[[gnu::noinline]] void repeat(Record& r, const Shadow& shadow, std::size_t offset, const void* p,
                              std::size_t bytes) {
  if (bytes > sizeof r.repeated_value)
    race("a write of many bytes:", shadow.words[offset / 4].writes);
  r.repeated = p;
  r.repeated_bytes = bytes;
  std::memcpy(r.repeated_value, p, bytes);
}

[[gnu::noinline]] void let_others_run_now(Record& r) {
  r.until_switch = next_switch(false);
  let_others_run();
}

/// Inlined into each function that the compiler calls, so that size and kind are known there.
[[gnu::always_inline]] inline void access(const void* p, std::size_t bytes, Kind kind) {
  if (!in_kernel) return;
  Record& r = the_record;
  if (r.repeated != nullptr) check_repeated(r);
  const auto* at = static_cast<const char*>(p);
  const Shadow* shadow = &r.of_device;
  auto offset = static_cast<std::size_t>(at - r.arena);
  std::uint32_t since = r.launch;
  bool in_shared = false;
  if (offset >= device_arena_bytes) {
    offset = static_cast<std::size_t>(at - reinterpret_cast<char*>(r.shared));
    if (offset >= r.shared_bytes) return;
    in_shared = true;
    shadow = &r.of_shared;
    since = r.block;
  }
  if (--r.until_switch == 0) let_others_run_now(r);
  const bool words = bytes >= 4;
  bool repeats = false;
  for (std::size_t k = 0; k < bytes; k += words ? 4 : bytes) {
    Cell& cell = words ? shadow->words[(offset + k) / 4] : shadow->bytes[offset];
    if (in_shared && kind == Kind::read && bytes <= 8 && cell.writes.tick < since &&
        shadow->words[(offset + k) / 4].writes.tick < since)
      violation("a read of shared memory that nobody wrote");
    repeats |= touch(r, cell, kind, since);
  }
  if (repeats) repeat(r, *shadow, offset, p, bytes);
}

}  // namespace

char* device_arena() {
  the_record.reserve();
  return the_record.arena;
}

void forget_accesses(const char* begin, std::size_t bytes) {
  Record& r = the_record;
  const auto offset = static_cast<std::size_t>(begin - r.arena);
  (void)madvise(r.of_device.words + offset / 4, bytes / 4 * sizeof(Cell), MADV_DONTNEED);
  (void)madvise(r.of_device.bytes + offset, bytes * sizeof(Cell), MADV_DONTNEED);
}

void launch_begins() {
  Record& r = the_record;
  r.reserve();
  r.launch = ++r.now;
  r.blocks = 0;
}

void block_begins(unsigned warps, unsigned char* shared, std::size_t bytes) {
  if (bytes > most_shared) violation("more shared memory than any device has");
  Record& r = the_record;
  r.block = r.barrier = ++r.now;
  r.shared = shared;
  r.shared_bytes = bytes;
  std::fill_n(r.warps, warps, r.now);
  ++r.blocks;
  r.until_switch = next_switch(true);
}

void thread_runs(unsigned thread) {
  Record& r = the_record;
  r.me = (r.blocks << block_shift & block_bits) | thread;
  r.my_warp_since = r.warps[thread / warp_lanes];
  in_kernel = true;
}

void thread_stops() {
  if (the_record.repeated != nullptr) check_repeated(the_record);
  in_kernel = false;
}

void warp_is_synchronised(unsigned warp) {
  Record& r = the_record;
  r.my_warp_since = r.warps[warp] = ++r.now;
}

void block_is_synchronised() {
  Record& r = the_record;
  r.barrier = ++r.now;
}

void atomic_access(const void* address, std::size_t bytes) {
  if (bytes == 4)
    access(address, 4, Kind::atomic);
  else
    access(address, bytes, Kind::atomic);
}

}  // namespace emulation

// ------------------------------------------------------------------ what the compiler calls

using emulation::access;
using emulation::Kind;

#define CULLHULL_ACCESSES(bytes)                                                                 \
  void __tsan_read##bytes(void* p) { access(p, bytes, Kind::read); }                             \
  void __tsan_write##bytes(void* p) { access(p, bytes, Kind::write); }                           \
  void __tsan_unaligned_read##bytes(void* p) { access(p, bytes, Kind::read); }                   \
  void __tsan_unaligned_write##bytes(void* p) { access(p, bytes, Kind::write); }                 \
  void __tsan_volatile_read##bytes(void* p) { access(p, bytes, Kind::volatile_read); }           \
  void __tsan_volatile_write##bytes(void* p) { access(p, bytes, Kind::write); }                  \
  void __tsan_unaligned_volatile_read##bytes(void* p) { access(p, bytes, Kind::volatile_read); } \
  void __tsan_unaligned_volatile_write##bytes(void* p) { access(p, bytes, Kind::write); }

// Atomic operations of the host's code in the kernels' texts.
#define CULLHULL_ATOMICS(bits, T)                                                                  \
  T __tsan_atomic##bits##_load(const volatile T* a, int) {                                         \
    return __atomic_load_n(a, __ATOMIC_SEQ_CST);                                                   \
  }                                                                                                \
  void __tsan_atomic##bits##_store(volatile T* a, T v, int) {                                      \
    __atomic_store_n(a, v, __ATOMIC_SEQ_CST);                                                      \
  }                                                                                                \
  T __tsan_atomic##bits##_exchange(volatile T* a, T v, int) {                                      \
    return __atomic_exchange_n(a, v, __ATOMIC_SEQ_CST);                                            \
  }                                                                                                \
  T __tsan_atomic##bits##_fetch_add(volatile T* a, T v, int) {                                     \
    return __atomic_fetch_add(a, v, __ATOMIC_SEQ_CST);                                             \
  }                                                                                                \
  T __tsan_atomic##bits##_fetch_sub(volatile T* a, T v, int) {                                     \
    return __atomic_fetch_sub(a, v, __ATOMIC_SEQ_CST);                                             \
  }                                                                                                \
  T __tsan_atomic##bits##_fetch_and(volatile T* a, T v, int) {                                     \
    return __atomic_fetch_and(a, v, __ATOMIC_SEQ_CST);                                             \
  }                                                                                                \
  T __tsan_atomic##bits##_fetch_or(volatile T* a, T v, int) {                                      \
    return __atomic_fetch_or(a, v, __ATOMIC_SEQ_CST);                                              \
  }                                                                                                \
  int __tsan_atomic##bits##_compare_exchange_strong(volatile T* a, T* expected, T v, int, int) {   \
    return __atomic_compare_exchange_n(a, expected, v, false, __ATOMIC_SEQ_CST, __ATOMIC_SEQ_CST); \
  }                                                                                                \
  int __tsan_atomic##bits##_compare_exchange_weak(volatile T* a, T* expected, T v, int, int) {     \
    return __atomic_compare_exchange_n(a, expected, v, true, __ATOMIC_SEQ_CST, __ATOMIC_SEQ_CST);  \
  }

extern "C" {
void __tsan_init() {}
void __tsan_func_entry(void*) {}
void __tsan_func_exit() {}
void __tsan_vptr_update(void*, void*) {}
void __tsan_vptr_read(void*) {}
void __tsan_atomic_thread_fence(int) { __atomic_thread_fence(__ATOMIC_SEQ_CST); }
void __tsan_atomic_signal_fence(int) {}
void __tsan_read_range(void* p, std::size_t bytes) { access(p, bytes, Kind::read); }
void __tsan_write_range(void* p, std::size_t bytes) { access(p, bytes, Kind::write); }
CULLHULL_ACCESSES(1)
CULLHULL_ACCESSES(2)
CULLHULL_ACCESSES(4)
CULLHULL_ACCESSES(8)
CULLHULL_ACCESSES(16)
CULLHULL_ATOMICS(8, unsigned char)
CULLHULL_ATOMICS(16, unsigned short)
CULLHULL_ATOMICS(32, unsigned int)
CULLHULL_ATOMICS(64, unsigned long)
}
