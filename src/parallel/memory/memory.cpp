#include "parallel/memory/memory.hpp"

#include "cullhull/error.hpp"
#include "parallel/windows.hpp"
#if !defined(_WIN32) && __has_include(<unistd.h>) && __has_include(<sys/resource.h>)
#include <sys/resource.h>
#include <unistd.h>
#endif

#include <algorithm>
#include <charconv>
#include <cstdio>
#include <limits>

namespace cullhull::internal {
namespace {

constexpr std::uint64_t no_limit = std::numeric_limits<std::uint64_t>::max();

/// The text of a file of some lines; empty if it cannot be read. Not by a stream, whose first use
/// makes the locales of a process, which takes longer than all of these files.
std::string text_of(const std::string& path) {
  std::string text;
  if (std::FILE* const file = std::fopen(path.c_str(), "r")) {
    std::setvbuf(file, nullptr, _IONBF, 0);
    char part[512];
    for (std::size_t n; (n = std::fread(part, 1, sizeof part, file)) > 0;) text.append(part, n);
    std::fclose(file);
  }
  return text;
}

/// Reads a limit from a file, which contains one number or the word "max". Returns no_limit for
/// "max" and for a file that cannot be read.
std::uint64_t limit_in(const std::string& path) {
  const std::string text = text_of(path);
  std::uint64_t bytes = 0;
  return std::from_chars(text.data(), text.data() + text.size(), bytes).ec == std::errc()
             ? bytes
             : no_limit;
}

/// The least limit of a group and of the groups that contain it, up to the root. In a container the
/// outer groups are invisible, and the container's own group is mounted at the root.
std::uint64_t limit_upwards(const std::string& root, std::string group, const char* name) {
  std::uint64_t least = no_limit;
  for (;;) {
    least = std::min(least, limit_in(root + group + "/" + name));
    if (group.empty()) return least;
    group.resize(group.rfind('/') == std::string::npos ? 0 : group.rfind('/'));
  }
}

/// The machine's memory in bytes, or the limit of this process's address space if that is less. 0
/// if unknown.
std::uint64_t addressable_memory() {
#if defined(_WIN32)
  MEMORYSTATUSEX status{};
  status.dwLength = sizeof status;
  if (!GlobalMemoryStatusEx(&status)) return 0;
  return std::min<std::uint64_t>(status.ullTotalPhys, status.ullTotalVirtual);
#elif defined(__EMSCRIPTEN__)
  return std::uint64_t{1} << 32;
#elif defined(_SC_PHYS_PAGES)
  const long pages = sysconf(_SC_PHYS_PAGES), size = sysconf(_SC_PAGESIZE);
  if (pages <= 0 || size <= 0) return 0;
  const auto physical = static_cast<std::uint64_t>(pages) * static_cast<std::uint64_t>(size);
  rlimit addresses{};
  const bool limited = getrlimit(RLIMIT_AS, &addresses) == 0 && addresses.rlim_cur != RLIM_INFINITY;
  return std::min(physical, limited ? std::uint64_t{addresses.rlim_cur} : no_limit);
#else
  return 0;
#endif
}

}  // namespace

std::uint64_t group_memory_limit(const std::string& groups, const std::string& root) {
  std::uint64_t least = no_limit;
  const std::string text = text_of(groups);
  for (std::size_t begin = 0, end = 0; begin < text.size(); begin = end + 1) {
    end = std::min(text.find('\n', begin), text.size());
    const std::string line = text.substr(begin, end - begin);  // "4:memory:/group", "0::/group"
    const auto first = line.find(':');
    const auto second = first == std::string::npos ? first : line.find(':', first + 1);
    if (second == std::string::npos) continue;
    std::string controllers = line.substr(first, second - first + 1);
    controllers.front() = controllers.back() = ',';
    const std::string group = line.substr(second + 1);
    if (controllers == ",,")
      least = std::min(least, limit_upwards(root, group, "memory.max"));
    else if (controllers.find(",memory,") != std::string::npos)
      least = std::min(least, limit_upwards(root + "/memory", group, "memory.limit_in_bytes"));
  }
  return least;
}

std::uint64_t machine_memory() {
#if defined(__EMSCRIPTEN__)
  return addressable_memory();  // there are no groups
#else
  static const std::uint64_t bytes =
      std::min(addressable_memory(), group_memory_limit("/proc/self/cgroup", "/sys/fs/cgroup"));
  return bytes;
#endif
}

std::uint64_t resolve_budget(std::uint64_t requested) {
  if (requested > 0) return requested;
  const std::uint64_t memory = machine_memory();
  return memory == 0 ? std::uint64_t{4} << 30 : memory / 2;
}

std::string size_text(std::uint64_t bytes) {
  return bytes < (std::uint64_t{1} << 20) ? std::to_string(bytes) + " bytes"
                                          : std::to_string(bytes >> 20) + " MiB";
}

void require_budget(std::uint64_t budget, std::uint64_t bytes, std::string_view what) {
  if (bytes <= budget) return;
  throw Error(ErrorCode::out_of_budget, what, " need about ", (bytes >> 20) + 1,
              " MiB, the memory budget is ", size_text(budget));
}

}  // namespace cullhull::internal
