#include "points/memory.hpp"

#include <unistd.h>

#include "cullhull/error.hpp"

namespace cullhull::internal {

std::uint64_t resolve_budget(std::uint64_t requested) {
  if (requested > 0) return requested;
  const long pages = sysconf(_SC_PHYS_PAGES), size = sysconf(_SC_PAGESIZE);
  if (pages <= 0 || size <= 0) return std::uint64_t{4} << 30;
  return static_cast<std::uint64_t>(pages) / 2 * static_cast<std::uint64_t>(size);
}

void require_budget(std::uint64_t budget, std::uint64_t bytes, const std::string& what) {
  if (bytes <= budget) return;
  throw Error(ErrorCode::out_of_budget, what + " need about " + std::to_string((bytes >> 20) + 1) +
                                            " MiB, the memory budget is " +
                                            std::to_string(budget >> 20) + " MiB");
}

}  // namespace cullhull::internal
