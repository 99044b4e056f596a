// Large blocks of memory, on huge pages where the system grants them. While a call is at work, what
// one step frees is kept for the next: memory from the system must be cleared first, which costs
// more than most steps do.
#pragma once

#include "cullhull/array.hpp"

namespace cullhull::internal {

/// As long as one of these lives, every freed block is kept and given out again; the last one to go
/// returns to the system what is beyond the limit of keep_memory(), and lets it have the rest when
/// it needs it. So at any time no more is held than the calls at work have needed at once, or the
/// limit.
class PageScope {
 public:
  PageScope();
  ~PageScope();
  PageScope(const PageScope&) = delete;
  PageScope& operator=(const PageScope&) = delete;
};

/// From this size on allocate_block gives blocks that begin at a cache line and that are kept.
/// Smaller ones never fill the end of malloc's heap by themselves.
inline constexpr std::size_t kept_block = std::size_t{4} << 10;

/// A larger block with the contents of `block`, which it replaces; all sizes at least
/// `mapped_block`, `bytes` as it was asked for. `more` becomes what there is room for: a block that
/// grows will grow again. Moves page tables rather than bytes where memory must be new.
inline constexpr std::size_t mapped_block = std::size_t{2} << 20;
void* grow_block(void* block, std::size_t bytes, std::size_t& more);

/// Asks that what lies whole huge pages wide between two addresses be such pages, before it is
/// first touched: advice, which changes nothing but time.
void prefer_huge_pages(void* begin, std::size_t bytes) noexcept;

/// Sets the limit of what is kept, in bytes, and gives back what is beyond it; what is kept now.
void keep_pages(std::size_t limit) noexcept;
std::size_t kept_pages() noexcept;

}  // namespace cullhull::internal
