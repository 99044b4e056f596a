// Data-parallel loops. Everything is deterministic: work is cut into chunks by size alone, never by
// thread count, and results are combined in chunk order.
#pragma once

#include <cstdint>
#include <functional>

namespace cullhull::internal::inline parallel {

/// Threads that will be used for a request (0: all the machine offers).
unsigned resolve_threads(unsigned requested);

/// Runs body(chunk, begin, end) for every chunk of `chunk_size` items of [0, count) on at most
/// `threads` threads; serial and in order for threads == 1. The caller works too, and does all
/// chunks where no helper is free (helpers.hpp). Asking for helpers costs a few microseconds:
/// chunks should take at least some ten of them. Exceptions pass through.
void for_each_chunk(
    std::uint64_t count, std::uint64_t chunk_size, unsigned threads,
    const std::function<void(std::uint64_t chunk, std::uint64_t begin, std::uint64_t end)>& body);

inline std::uint64_t chunk_count(std::uint64_t count, std::uint64_t chunk_size) {
  return (count + chunk_size - 1) / chunk_size;
}

}  // namespace cullhull::internal::inline parallel
