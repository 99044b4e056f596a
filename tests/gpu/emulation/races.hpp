// The accesses of running kernels to memory that their threads share. The kernels' text is compiled
// with -fsanitize=thread, so that the compiler calls a function before every access; the functions
// are defined in races.cpp, and the sanitizer's run-time library is not linked.
//
// Two accesses to one address are a race, and a violation, where they come from different threads
// of a launch, at least one is a write, not both are atomic, and nothing orders them. Threads of a
// warp are ordered by __syncwarp, threads of a block by __syncthreads, blocks by nothing. Ballots
// and shuffles order no memory. Plain writes of the same value are allowed.
#pragma once

#include <cstddef>
#include <cstdint>

namespace emulation {

// What block.cpp reports.
void launch_begins();
/// `shared`: the block's memory, of which nothing is written yet.
void block_begins(unsigned warps, unsigned char* shared, std::size_t bytes);
void thread_runs(unsigned thread);
/// The running thread stops: its last write has been done.
void thread_stops();
void warp_is_synchronised(unsigned warp);
void block_is_synchronised();

// What atomic operations report, in the place of the compiler.
void atomic_access(const void* address, std::size_t bytes);

/// The addresses of all device memory: [device_arena(), device_arena() + device_arena_bytes).
char* device_arena();
constexpr std::size_t device_arena_bytes = std::size_t{1} << 40;
/// Forgets the accesses to [begin, begin + bytes) of the arena, which are whole pages.
void forget_accesses(const char* begin, std::size_t bytes);

}  // namespace emulation
