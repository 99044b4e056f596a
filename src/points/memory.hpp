// The memory budget.
#pragma once

#include <cstdint>

namespace cullhull::internal {

/// Bytes a call may allocate: the request, or half of the machine's memory for 0.
std::uint64_t resolve_budget(std::uint64_t requested);

}  // namespace cullhull::internal
