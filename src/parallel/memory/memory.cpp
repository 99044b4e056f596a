#include "parallel/memory/memory.hpp"

#include "cullhull/error.hpp"
#include "parallel/memory/machine_memory.hpp"

namespace cullhull::internal::inline parallel {

std::uint64_t resolve_budget(std::uint64_t requested) {
  if (requested > 0) return requested;
  const std::uint64_t memory = machine_memory();
  return memory == 0 ? std::uint64_t{4} << 30 : memory / 2;
}

namespace {

std::string size_text(std::uint64_t bytes) {
  return bytes < (std::uint64_t{1} << 20) ? std::to_string(bytes) + " bytes"
                                          : std::to_string(bytes >> 20) + " MiB";
}

}  // namespace

void require_budget(std::uint64_t budget, std::uint64_t bytes, const std::string& what) {
  if (bytes <= budget) return;
  throw Error(ErrorCode::out_of_budget, what, " need about ", (bytes >> 20) + 1,
              " MiB, the memory budget is ", size_text(budget));
}

}  // namespace cullhull::internal::inline parallel
