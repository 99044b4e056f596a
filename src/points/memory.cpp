#include "points/memory.hpp"

#include <unistd.h>

namespace cullhull::internal {

std::uint64_t resolve_budget(std::uint64_t requested) {
  if (requested > 0) return requested;
  const long pages = sysconf(_SC_PHYS_PAGES), size = sysconf(_SC_PAGESIZE);
  if (pages <= 0 || size <= 0) return std::uint64_t{4} << 30;
  return static_cast<std::uint64_t>(pages) / 2 * static_cast<std::uint64_t>(size);
}

}  // namespace cullhull::internal
