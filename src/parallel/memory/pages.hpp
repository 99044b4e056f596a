// Large blocks of memory, on huge pages if the system grants them. During a call, blocks that one
// step frees are kept for the next steps: the system must clear new memory, which takes longer than
// most steps.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "cullhull/array.hpp"
#include "parallel/threads/parallel.hpp"

namespace cullhull::internal {

/// While any PageScope exists, freed blocks of at least mapped_block bytes are kept and reused.
/// When the last PageScope is destroyed, kept memory beyond the limit of keep_memory() is returned
/// to the system, and the system may reclaim the rest when it needs memory. So the process never
/// holds more than its running calls have needed at once, or the limit.
class PageScope {
 public:
  PageScope();
  ~PageScope();
  PageScope(const PageScope&) = delete;
  PageScope& operator=(const PageScope&) = delete;
};

/// From this size in bytes on, allocate_block returns blocks that begin at a cache line and that
/// are reused. Smaller blocks come from operator new; they alone do not make malloc return and
/// request the end of its heap again and again.
inline constexpr std::size_t kept_block = std::size_t{4} << 10;

/// From this size in bytes on, blocks are whole huge pages, mapped by the system (on Linux).
inline constexpr std::size_t mapped_block = std::size_t{2} << 20;
/// Replaces `block` by a larger block with the same contents and returns the new one. `bytes`: the
/// size requested for `block`; `more`: the new size; both at least mapped_block. Sets `more` to the
/// new capacity, which may exceed the request, since a block that grows is likely to grow again. If
/// new memory is needed, the function moves page tables instead of copying bytes, if it can. Throws
/// std::bad_alloc.
void* grow_block(void* block, std::size_t bytes, std::size_t& more);

/// Asks the system for huge pages within [begin, begin + bytes). Call it before the memory is first
/// written. It is advice only, which affects nothing but speed.
void prefer_huge_pages(void* begin, std::size_t bytes) noexcept;

/// Sets the limit, in bytes, of unused memory kept between calls, and returns memory beyond it to
/// the system. Large blocks are returned only when no PageScope exists.
void keep_pages(std::size_t limit) noexcept;
/// The bytes of unused memory that are kept now.
std::size_t kept_pages() noexcept;

/// Returns unused large blocks to the system until at most `most` bytes of them are kept. The limit
/// of keep_pages() stays.
void trim_pages(std::size_t most) noexcept;

/// Writes one byte of every huge page (2 MiB) of a block whose contents do not matter. The system
/// clears a new page when it is first written. Without this function, the first chunk of a loop
/// with scattered writes would make the system clear the whole block, and cancellation is not
/// checked within a chunk. Calls check() before each page.
template <class Check>
void clear_pages_early(void* block, std::size_t bytes, unsigned threads, const Check& check) {
  constexpr std::size_t page = std::size_t{2} << 20;
  if (bytes <= page) return;
  auto* const start = static_cast<volatile std::uint8_t*>(block);
  for_each_chunk(chunk_count(bytes, page), 1, threads,
                 [&](std::uint64_t, std::uint64_t begin, std::uint64_t end) {
    for (std::uint64_t i = begin; i < end; ++i) {
      check();
      start[i * page] = 0;
    }
  });
}

}  // namespace cullhull::internal
