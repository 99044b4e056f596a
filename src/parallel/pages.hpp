// Large blocks of memory, on huge pages where the system grants them. While a call is at work, what
// one step frees is kept for the next: memory from the system must be cleared first, which costs
// more than most steps do.
#pragma once

#include "cullhull/array.hpp"

namespace cullhull::internal {

/// As long as one of these lives, freed blocks are kept and given out again; the last one to go
/// returns what is left to the system. So nothing is held between calls, and at any time no more
/// than the calls at work have needed at once.
class PageScope {
 public:
  PageScope();
  ~PageScope();
  PageScope(const PageScope&) = delete;
  PageScope& operator=(const PageScope&) = delete;
};

}  // namespace cullhull::internal
