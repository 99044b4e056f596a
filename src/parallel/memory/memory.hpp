// The memory budget, and how much memory there is to plan with.
#pragma once

#include <cstdint>
#include <string>

namespace cullhull::internal::inline parallel {

/// Bytes a call may allocate: the request, or half of machine_memory() for 0.
std::uint64_t resolve_budget(std::uint64_t requested);

/// Throws Error{out_of_budget}, naming `what`, if it needs more bytes than the budget has.
void require_budget(std::uint64_t budget, std::uint64_t bytes, const std::string& what);

// How much memory there is to plan with.

/// Bytes this process may use: the machine's memory or, where that is less, the limit of its
/// control groups (those of a container, say). 0 where the system does not tell. Determined once.
std::uint64_t machine_memory();

/// The least limit of the control groups that the file `groups` (/proc/self/cgroup) names and of
/// those that contain them, whose files lie in `root` (/sys/fs/cgroup), versions 1 and 2; the
/// greatest number where there is none.
std::uint64_t group_memory_limit(const std::string& groups, const std::string& root);

}  // namespace cullhull::internal::inline parallel
