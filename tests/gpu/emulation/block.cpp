#include "block.hpp"

#include <sys/mman.h>

#include <algorithm>
#include <cstring>
#include <string>
#include <vector>

#include "emulation.hpp"
#include "races.hpp"

namespace emulation {

Index thread_index, block_index, block_size, grid_size;

// Saves what a call must keep and goes on where the other fiber stopped (System V, x86-64 and
// AArch64).
extern "C" void emulation_switch(void** from, void* to);
#if defined(__x86_64__)
asm(R"(
.text
.globl emulation_switch
.type emulation_switch,@function
emulation_switch:
  pushq %rbp
  pushq %rbx
  pushq %r12
  pushq %r13
  pushq %r14
  pushq %r15
  movq %rsp, (%rdi)
  movq %rsi, %rsp
  popq %r15
  popq %r14
  popq %r13
  popq %r12
  popq %rbx
  popq %rbp
  ret
.size emulation_switch,.-emulation_switch
)");
#else
#error "the emulated device switches fibers on x86-64 only"
#endif

namespace {

constexpr unsigned warp_lanes = 32, no_thread = ~0U;
constexpr std::size_t stack_bytes = 128 << 10;
constexpr unsigned char garbage = 0xEE, canary = 0x5A;
constexpr std::size_t canary_bytes = 32;

enum class Waits { no, for_block, for_warp };

struct Fiber {
  void* stack_pointer = nullptr;
  char* stack = nullptr;  ///< from where it begins to where it ends
  bool begun = false, done = true;
  Waits waits = Waits::no;
  std::uint64_t turn = 0;  ///< the barrier's or the warp's when it began to wait
};

struct Warp {
  std::uint64_t values[2][warp_lanes];
  unsigned arrived = 0;
  std::uint64_t turn = 0;
  const char* where = nullptr;
};

struct Block {
  std::vector<Fiber> fibers;
  std::vector<Warp> warps;
  std::vector<unsigned> order;
  std::size_t turn_of = 0;  ///< in `order`: whose turn comes next
  bool moved = false;       ///< a thread had a turn since the order began
  std::vector<char*> free_stacks;
  unsigned stacks = 0;
  std::vector<unsigned char> shared;
  unsigned char* shared_begin = nullptr;
  std::size_t shared_used = 0;
  struct Static {
    const char* where;
    std::size_t begin, bytes;
  };
  std::vector<Static> statics;
  const std::function<void()>* body = nullptr;
  void* scheduler = nullptr;
  unsigned current = 0, threads = 0, alive = 0, arrived = 0;
  std::uint64_t turn = 0;
  const char* where = nullptr;
};

constinit Block the_block;
void* ended;  ///< where a switch away from a thread that has ended saves its stack pointer

bool must_wait(const Block& b, unsigned thread) {
  const Fiber& f = b.fibers[thread];
  return (f.waits == Waits::for_block && f.turn == b.turn) ||
         (f.waits == Waits::for_warp && f.turn == b.warps[thread / warp_lanes].turn);
}

/// The thread whose turn it is: each that can go on has one, in the block's order, again and again;
/// `no_thread`: all have ended.
unsigned next_thread(Block& b) {
  for (;;) {
    while (b.turn_of < b.threads) {
      const unsigned thread = b.order[b.turn_of++];
      if (b.fibers[thread].done || must_wait(b, thread)) continue;
      b.moved = true;
      return thread;
    }
    if (b.alive == 0) return no_thread;
    if (!b.moved) violation("threads wait for others that have left");
    b.turn_of = 0;
    b.moved = false;
  }
}

void make_current(Block& b, unsigned thread) {
  b.fibers[thread].waits = Waits::no;
  b.current = thread;
  thread_index = {thread, 0, 0};
  thread_runs(thread);
}

extern "C" void emulation_fiber_entry();

/// Memory for a thread's stack, with the entry on top as if it had been switched away from. Tops
/// are not at the same place of a page, or all would share a few lines of the cache.
void give_stack(Block& b, Fiber& fiber) {
  if (b.free_stacks.empty()) {
    void* memory =
        mmap(nullptr, stack_bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    if (memory == MAP_FAILED) violation("no memory is left for the stacks of threads");
    b.free_stacks.push_back(static_cast<char*>(memory) + stack_bytes - 64 -
                            b.stacks++ % 32 * std::size_t{256});
  }
  fiber.stack = b.free_stacks.back();
  b.free_stacks.pop_back();
  auto* top = reinterpret_cast<void**>(fiber.stack);
  *--top = nullptr;  // in the place of a return address: keeps the stack aligned as calls do
  *--top = reinterpret_cast<void*>(&emulation_fiber_entry);
  for (int saved = 0; saved < 6; ++saved) *--top = nullptr;
  fiber.stack_pointer = top;
}

void switch_to(Block& b, unsigned thread, void** save) {
  Fiber& fiber = b.fibers[thread];
  if (!fiber.begun) give_stack(b, fiber);
  fiber.begun = true;
  make_current(b, thread);
  emulation_switch(save, fiber.stack_pointer);
}

/// The running thread stops, and the next one goes on.
void suspend() {
  Block& b = the_block;
  thread_stops();
  const unsigned me = b.current, next = next_thread(b);
  if (next == me)
    make_current(b, me);
  else
    switch_to(b, next, &b.fibers[me].stack_pointer);
}

/// Runs a thread, and on the same stack those after it that have not begun.
extern "C" void emulation_fiber_entry() {
  Block& b = the_block;
  for (;;) {
    (*b.body)();
    Fiber& fiber = b.fibers[b.current];
    fiber.done = true;
    --b.alive;
    thread_stops();
    const unsigned next = next_thread(b);
    if (next != no_thread && !b.fibers[next].begun) {
      b.fibers[next].begun = true;
      b.fibers[next].stack = fiber.stack;
      make_current(b, next);
      continue;
    }
    b.free_stacks.push_back(fiber.stack);  // and nothing takes it before the switch
    if (next == no_thread)
      emulation_switch(&ended, b.scheduler);
    else
      switch_to(b, next, &ended);
    violation("a thread that had ended went on");
  }
}

/// Forwards, backwards or anyhow.
void vary_order(std::vector<unsigned>& order, unsigned threads) {
  order.resize(threads);
  for (unsigned i = 0; i < threads; ++i) order[i] = i;
  const std::uint64_t choice = random64() % 8;
  if (choice % 2 == 1) std::reverse(order.begin(), order.end());
  if (choice >= 6)
    for (unsigned i = threads; i > 1; --i) std::swap(order[i - 1], order[random64() % i]);
}

constexpr std::size_t shared_alignment = 64, most_static = 48 << 10, most_dynamic = 227 << 10;

/// Garbage, and what shows a write behind it.
void spoil(unsigned char* begin, std::size_t bytes) {
  std::memset(begin, garbage, bytes);
  std::memset(begin + bytes, canary, canary_bytes);
}
void check_end(const unsigned char* begin, std::size_t bytes) {
  const unsigned char* end = begin + bytes;
  if (!std::all_of(end, end + canary_bytes, [](unsigned char c) { return c == canary; }))
    violation("a write behind the block's shared memory");
}
std::size_t shared_room(std::size_t bytes) {
  return (bytes + canary_bytes + shared_alignment - 1) / shared_alignment * shared_alignment;
}

void lay_shared(Block& b, std::size_t bytes) {
  if (b.shared.empty())
    b.shared.resize(2 * (shared_room(most_dynamic) + most_static) + shared_alignment);
  const auto address = reinterpret_cast<std::uintptr_t>(b.shared.data());
  b.shared_begin =
      b.shared.data() + (shared_alignment - address % shared_alignment) % shared_alignment;
  b.shared_used = shared_room(bytes);
  b.statics.clear();
  spoil(b.shared_begin, bytes);
  block_begins(static_cast<unsigned>(b.warps.size()), b.shared_begin,
               b.shared.size() - shared_alignment);
}

}  // namespace

void run_block(const std::function<void()>& body, unsigned threads, std::size_t shared) {
  Block& b = the_block;
  b.body = &body;
  b.threads = b.alive = threads;
  b.arrived = 0;
  if (b.fibers.size() < threads) b.fibers.resize(threads);
  b.warps.resize((threads + warp_lanes - 1) / warp_lanes);
  for (Warp& warp : b.warps) warp.arrived = 0;
  lay_shared(b, shared);
  for (unsigned t = 0; t < threads; ++t) {
    b.fibers[t].begun = b.fibers[t].done = false;
    b.fibers[t].waits = Waits::no;
  }
  vary_order(b.order, threads);
  b.turn_of = 0;
  b.moved = false;
  switch_to(b, next_thread(b), &b.scheduler);
  check_end(b.shared_begin, shared);
  for (const Block::Static& s : b.statics) check_end(b.shared_begin + s.begin, s.bytes);
}

void let_others_run() { suspend(); }

void require_threads(unsigned most, const char* kernel) {
  if (the_block.threads > most)
    violation(std::string(kernel) + " is launched with " + std::to_string(the_block.threads) +
              " threads, its launch bounds are " + std::to_string(most));
}

void* static_shared_memory(std::size_t bytes, const char* where) {
  Block& b = the_block;
  for (const Block::Static& s : b.statics)
    if (s.where == where) return b.shared_begin + s.begin;
  b.statics.push_back({where, b.shared_used, bytes});
  unsigned char* begin = b.shared_begin + b.shared_used;
  b.shared_used += shared_room(bytes);
  if (b.shared_used > b.shared.size() - shared_alignment)
    violation("more static shared memory than a block may have");
  spoil(begin, bytes);
  return begin;
}

void* dynamic_shared_memory() { return the_block.shared_begin; }

void barrier(const char* where) {
  Block& b = the_block;
  if (b.arrived == 0)
    b.where = where;
  else if (b.where != where && std::strcmp(b.where, where) != 0)
    violation(std::string("threads of a block meet at two barriers: ") + b.where + ", " + where);
  if (b.alive != b.threads) violation(std::string("threads have left before ") + where);
  const std::uint64_t turn = b.turn;
  if (++b.arrived == b.threads) {
    b.arrived = 0;
    ++b.turn;
    block_is_synchronised();
    return;
  }
  b.fibers[b.current].waits = Waits::for_block;
  b.fibers[b.current].turn = turn;
  suspend();
}

std::uint64_t warp_operation(WarpOperation which, unsigned mask, std::uint64_t value, int argument,
                             const char* where) {
  if (mask != 0xFFFFFFFFU) violation(std::string("not all lanes are named at ") + where);
  Block& b = the_block;
  Warp& warp = b.warps[b.current / warp_lanes];
  const unsigned lane = b.current % warp_lanes;
  if (warp.arrived == 0)
    warp.where = where;
  else if (warp.where != where && std::strcmp(warp.where, where) != 0)
    violation(std::string("lanes of a warp are at two operations: ") + warp.where + ", " + where);
  // Two sets of values: a lane may come to the next operation while others still read this one's.
  const std::uint64_t turn = warp.turn;
  std::uint64_t* values = warp.values[turn % 2];
  values[lane] = value;
  if (++warp.arrived == warp_lanes) {
    warp.arrived = 0;
    ++warp.turn;
    if (which == WarpOperation::wait) warp_is_synchronised(b.current / warp_lanes);
  } else {
    b.fibers[b.current].waits = Waits::for_warp;
    b.fibers[b.current].turn = turn;
    suspend();
  }
  switch (which) {
    case WarpOperation::shuffle_xor:
      return values[lane ^ static_cast<unsigned>(argument)];
    case WarpOperation::shuffle_down:
      return lane + static_cast<unsigned>(argument) < warp_lanes
                 ? values[lane + static_cast<unsigned>(argument)]
                 : value;
    case WarpOperation::ballot:
      break;
    case WarpOperation::wait:
      return 0;
  }
  std::uint64_t bits = 0;
  for (unsigned i = 0; i < warp_lanes; ++i) bits |= (values[i] & 1) << i;
  return bits;
}

}  // namespace emulation
