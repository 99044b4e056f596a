// Large blocks of memory, on huge pages where the system grants them. During a call, what one step
// frees is kept for the next: memory from the system must be cleared first, which costs more than
// most steps do.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "cullhull/array.hpp"
#include "parallel/threads/parallel.hpp"

namespace cullhull::internal::inline parallel {

/// While any of these lives, every freed block is kept and reused; the last one to be destroyed
/// returns to the system what is beyond the limit of keep_memory(), and lets it reclaim the rest
/// when it needs memory. So no more is held at any time than the running calls have needed at once,
/// or the limit.
class PageScope {
 public:
  PageScope();
  ~PageScope();
  PageScope(const PageScope&) = delete;
  PageScope& operator=(const PageScope&) = delete;
};

/// From this size on allocate_block gives blocks that begin at a cache line and that are reused.
/// Smaller ones never fill the end of malloc's heap by themselves.
inline constexpr std::size_t kept_block = std::size_t{4} << 10;

/// A larger block with the contents of `block`, which it replaces; all sizes at least
/// `mapped_block`, `bytes` the size requested for `block`. `more` becomes the capacity, which may
/// exceed the request: a block that grows will grow again. Where memory must be new, page tables
/// are moved and not bytes.
inline constexpr std::size_t mapped_block = std::size_t{2} << 20;
void* grow_block(void* block, std::size_t bytes, std::size_t& more);

/// Requests huge pages for the whole ones between two addresses, before they are first written:
/// only advice, which changes nothing but time.
void prefer_huge_pages(void* begin, std::size_t bytes) noexcept;

/// Sets the limit of what is kept, in bytes, and gives back what is beyond it; what is kept now.
void keep_pages(std::size_t limit) noexcept;
std::size_t kept_pages() noexcept;

/// Gives back what is kept beyond so many bytes, once; the limit stays.
void trim_pages(std::size_t most) noexcept;

// New memory is cleared by the system when it is first written to, two megabytes at a time.

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
