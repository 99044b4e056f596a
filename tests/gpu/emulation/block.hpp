// One block of threads at a time: fibers that take turns at barriers, at warp operations and, in
// some blocks, before any access to memory that threads share (races.hpp), in varied orders, so
// that what depends on an order of threads shows.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>

namespace emulation {

struct Index {
  unsigned x = 0, y = 0, z = 0;
};
/// Of the thread that runs now.
extern Index thread_index, block_index, block_size, grid_size;

/// Runs `body` once for each of `threads` threads, with `shared` bytes of dynamic shared memory,
/// which hold garbage at first and are checked for writes beyond their end.
void run_block(const std::function<void()>& body, unsigned threads, std::size_t shared);

enum class WarpOperation { shuffle_xor, shuffle_down, ballot, wait };

// What kernels call. `where` tells one call in the text from another: threads that meet at
// different ones are a violation, and so are threads that have left.
void barrier(const char* where);
std::uint64_t warp_operation(WarpOperation which, unsigned mask, std::uint64_t value, int argument,
                             const char* where);
void* dynamic_shared_memory();
/// The block's static shared memory of one declaration, which `where` tells from others.
void* static_shared_memory(std::size_t bytes, const char* where);
/// __launch_bounds__: a violation if the block has more threads than the kernel was compiled for.
void require_threads(unsigned most, const char* kernel);
/// The running thread goes on later.
void let_others_run();

}  // namespace emulation
