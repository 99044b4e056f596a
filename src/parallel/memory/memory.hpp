// The memory budget.
#pragma once

#include <cstdint>
#include <string>

namespace cullhull::internal::inline parallel {

/// Bytes a call may allocate: the request, or half of machine_memory() for 0.
std::uint64_t resolve_budget(std::uint64_t requested);

/// Throws Error{out_of_budget}, naming `what`, if it needs more bytes than the budget has.
void require_budget(std::uint64_t budget, std::uint64_t bytes, const std::string& what);

}  // namespace cullhull::internal::inline parallel
