// The memory that the library keeps between calls: pages, pinned and device memory, scratch of
// threads.
#include "cuda/backend.hpp"
#include "cullhull/array.hpp"
#include "parallel/memory/pages.hpp"
#include "parallel/threads/thread_memory.hpp"

namespace cullhull {

void keep_memory(std::size_t limit) noexcept {
  internal::keep_pages(limit);
  if (limit > 0) return;
  internal::drop_device_memory();
  internal::drop_thread_memory();
}

std::size_t kept_memory() noexcept { return internal::kept_pages(); }

}  // namespace cullhull
