#include "io/blocks/read_ahead.hpp"

#include <cerrno>
#include <map>
#include <mutex>
#include <system_error>
#include <utility>

#include "cullhull/error.hpp"
#include "io/source.hpp"
#include "io/system.hpp"

namespace cullhull::internal {
namespace {

/// By path. A pipe cannot be opened twice: its reader takes the descriptor along with the bytes.
struct Waiting {
  std::mutex mutex;
  std::map<std::string, ReadAhead> pipes;
};

Waiting& waiting() {
  static auto* const all = new Waiting;  // outlives every static object
  return *all;
}

[[noreturn]] void refuse(const std::string& path, const char* doing) {
  throw Error(ErrorCode::io, display_name(path), ": ", doing, ": ",
              std::generic_category().message(errno));
}

}  // namespace

bool is_pipe(const std::string& path) {
  if (path == "-") return true;
  system::FileStatus status{};
  return system::status_of(path.c_str(), status) == 0 && !system::is_regular(status) &&
         !system::is_folder(status);
}

bool read_ahead(const std::string& path, std::size_t most, const stop_token& stop) {
  Waiting& all = waiting();
  const std::lock_guard lock(all.mutex);
  const auto found = all.pipes.find(path);
  if (found != all.pipes.end()) return found->second.bytes.size() >= most;
  ReadAhead ahead;
  ahead.file =
      Descriptor(path == "-" ? system::standard_input : system::open_to_read(path.c_str()));
  const int fd = ahead.file.get();
  if (fd < 0) refuse(path, "cannot open");
  system::enlarge_pipe(fd);
  std::size_t have = 0;
  ahead.bytes.resize(most);
  while (have < most) {
    do {
      if (stop.stop_requested()) throw Error(ErrorCode::cancelled, "cancelled");
    } while (!system::readable_soon(fd));
    const std::ptrdiff_t got = system::read_some(fd, ahead.bytes.data() + have, most - have);
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) refuse(path, "cannot read");
    if (got == 0) break;
    have += static_cast<std::size_t>(got);
  }
  ahead.bytes.resize(have);
  all.pipes.emplace(path, std::move(ahead));
  return have == most;
}

std::optional<ReadAhead> take_read_ahead(const std::string& path) {
  Waiting& all = waiting();
  const std::lock_guard lock(all.mutex);
  const auto found = all.pipes.find(path);
  if (found == all.pipes.end()) return std::nullopt;
  std::optional<ReadAhead> taken(std::move(found->second));
  all.pipes.erase(found);
  return taken;
}

std::string_view seen_ahead(const std::string& path) {
  Waiting& all = waiting();
  const std::lock_guard lock(all.mutex);
  const auto found = all.pipes.find(path);
  return found == all.pipes.end() ? std::string_view() : found->second.bytes;
}

}  // namespace cullhull::internal
