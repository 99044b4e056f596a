// The memory budget of a call, and the memory available to the process.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace cullhull::internal {

/// The bytes that a call may allocate: the request; for 0, half of machine_memory(), or 4 GiB if
/// that is unknown.
std::uint64_t resolve_budget(std::uint64_t requested);

/// Throws Error{out_of_budget} if `bytes`, which `what` needs, exceeds `budget`. `what` is the
/// plural noun that begins the message.
void require_budget(std::uint64_t budget, std::uint64_t bytes, std::string_view what);

/// "200 MiB", or "5000 bytes" below one MiB.
std::string size_text(std::uint64_t bytes);

/// The bytes that this process may use: the machine's memory, the limit of the process's address
/// space or the limit of its control groups (for instance a container's), whichever is least. 0 if
/// the system does not report its memory. Determined once.
std::uint64_t machine_memory();

/// The least memory limit, in bytes, of the control groups that the file `groups`
/// (/proc/self/cgroup) names and of the groups that contain them. Reads the limits from the tree
/// `root` (/sys/fs/cgroup), of version 1 or 2. Returns the greatest 64-bit number if no group has a
/// limit.
std::uint64_t group_memory_limit(const std::string& groups, const std::string& root);

}  // namespace cullhull::internal
