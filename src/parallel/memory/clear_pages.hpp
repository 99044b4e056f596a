// New memory is cleared by the system when it is first written to, two megabytes at a time.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "parallel/threads/parallel.hpp"

namespace cullhull::internal::inline parallel {

/// Writes one byte of every huge page of a block whose contents do not matter. Otherwise scattered
/// writes would make the system clear all of the block within their first chunk, during which
/// cancellation is not checked. `check` runs between pages.
template <class Check>
void clear_pages_early(void* block, std::size_t bytes, unsigned threads, const Check& check) {
  constexpr std::size_t page = std::size_t{2} << 20;
  if (bytes <= page) return;
  auto* const start = static_cast<volatile std::uint8_t*>(block);
  for_each_chunk(chunk_count(bytes, page), 8, threads,
                 [&](std::uint64_t, std::uint64_t begin, std::uint64_t end) {
    for (std::uint64_t i = begin; i < end; ++i) {
      check();
      start[i * page] = 0;
    }
  });
}

}  // namespace cullhull::internal::inline parallel
