#include "io/write/output_file.hpp"

#include <array>
#include <atomic>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <system_error>
#include <vector>

#include "cullhull/error.hpp"
#include "cullhull/io.hpp"
#include "io/source.hpp"
#include "io/system.hpp"
#include "parallel/paths.hpp"
#include "parallel/threads/run.hpp"

namespace cullhull::internal {
namespace {

// Read by a signal handler, so: fixed size, no lock, no allocation.
struct Unfinished {
  enum State : int { empty, claimed, listed };
  std::atomic<int> state{empty};
  char path[system::longest_path] = {};
};

constinit std::array<Unfinished, 32> unfinished;

int list_unfinished(const std::string& path) {
  for (std::size_t i = 0; i < unfinished.size(); ++i) {
    int expected = Unfinished::empty;
    if (!unfinished[i].state.compare_exchange_strong(expected, Unfinished::claimed)) continue;
    std::memcpy(unfinished[i].path, path.c_str(), path.size() + 1);
    unfinished[i].state.store(Unfinished::listed, std::memory_order_release);
    return static_cast<int>(i);
  }
  return -1;
}

std::error_code numbered(int error) { return {error, std::generic_category()}; }

constexpr std::size_t buffer_size = std::size_t{1} << 20;

}  // namespace

OutputFile::OutputFile(const std::string& path)
    : name_(path == "-" ? "standard output" : display_name(path)) {
  buffer_.reserve(buffer_size);
  if (path == "-") {
    descriptor_ = system::standard_output;
    return;
  }
  system::FileStatus status{};
  const bool exists = system::status_of(path.c_str(), status) == 0;
  if (exists && system::is_folder(status)) refuse("cannot write", numbered(EISDIR));
  if (exists && !system::is_regular(status)) {
    descriptor_ = system::open_to_write(path.c_str());
    if (descriptor_ < 0) refuse("cannot open", numbered(errno));
    return;
  }
  if (exists) {
    if (!system::may_write(path.c_str())) refuse("cannot write", numbered(errno));
    // Replaces the target of a link, not the link.
    std::error_code error;
    target_ = utf8_name(std::filesystem::canonical(native_path(path), error));
    if (error) refuse("cannot write", error);
  } else {
    target_ = path;
  }
  open_beside(target_);
  if (exists) system::set_permissions(descriptor_, status);  // best effort, as `cp` does
}

void OutputFile::open_beside(const std::string& path) {
  static std::atomic<unsigned> counter{0};
  for (int attempt = 0; attempt < 100; ++attempt) {
    temporary_ = path + "." + std::to_string(system::process_number()) + "-" +
                 std::to_string(counter++) + ".tmp";
    if (temporary_.size() >= system::longest_path) {
      temporary_.clear();
      refuse("cannot write", numbered(ENAMETOOLONG));
    }
    // Listed first: a signal between the two calls then removes a file that does not exist.
    slot_ = list_unfinished(temporary_);
    descriptor_ = system::create_file(temporary_.c_str());
    if (descriptor_ >= 0) return;
    const std::error_code error = numbered(errno);
    temporary_.clear();
    abandon();
    if (error != std::errc::file_exists) refuse("cannot write", error);
  }
  refuse("cannot write", numbered(EEXIST));
}

OutputFile::~OutputFile() { abandon(); }

void OutputFile::abandon() noexcept {
  if (descriptor_ >= 0 && descriptor_ != system::standard_output) system::close_file(descriptor_);
  descriptor_ = -1;
  if (!temporary_.empty()) system::remove_file(temporary_.c_str());
  temporary_.clear();
  if (slot_ >= 0) unfinished[static_cast<std::size_t>(slot_)].state.store(Unfinished::empty);
  slot_ = -1;
}

void OutputFile::refuse(const char* doing, const std::error_code& error) {
  abandon();
  throw Error(ErrorCode::io, name_, ": ", doing, ": ", error.message());
}

void OutputFile::write(std::string_view bytes) {
  if (buffer_.size() + bytes.size() <= buffer_size) {
    buffer_.append(bytes);
    return;
  }
  send(buffer_.data(), buffer_.size());
  buffer_.clear();
  if (bytes.size() >= buffer_size)
    send(bytes.data(), bytes.size());
  else
    buffer_.append(bytes);
}

void OutputFile::write_items(std::uint64_t count, const TextOfItems& text_of) {
  // 64 pieces of some 50 KB, which take a tenth of a millisecond each, are held at a time.
  constexpr std::uint64_t grain = 1024, together = 64 * grain;
  const Options options;
  const Call call(options, true);
  std::vector<std::string> texts(std::min(chunk_count(count, grain), together / grain));
  for (std::uint64_t first = 0; first < count; first += together) {
    const std::uint64_t items = std::min(together, count - first);
    call.run.each_chunk(items, grain, [&](std::uint64_t c, std::uint64_t begin, std::uint64_t end) {
      texts[c].clear();
      text_of(texts[c], first + begin, first + end);
    });
    for (std::uint64_t c = 0; c < chunk_count(items, grain); ++c) write(texts[c]);
  }
}

void OutputFile::send(const char* data, std::size_t size) {
  while (size > 0) {
    const std::ptrdiff_t sent = system::write_some(descriptor_, data, size);
    if (sent < 0 && errno == EINTR) continue;
    if (sent < 0) refuse("cannot write", numbered(errno));
    data += sent;
    size -= static_cast<std::size_t>(sent);
  }
}

void OutputFile::commit() {
  send(buffer_.data(), buffer_.size());
  buffer_.clear();
  // Some file systems report a full disk only here.
  if (descriptor_ != system::standard_output &&
      system::close_file(std::exchange(descriptor_, -1)) != 0)
    refuse("cannot write", numbered(errno));
  if (!temporary_.empty()) {
    std::error_code error;
    std::filesystem::rename(native_path(temporary_), native_path(target_), error);
    if (error) refuse("cannot rename to", error);
    temporary_.clear();
  }
  abandon();
}

}  // namespace cullhull::internal

namespace cullhull {

void remove_unfinished_files() noexcept {
  for (internal::Unfinished& u : internal::unfinished)
    if (u.state.load(std::memory_order_acquire) == internal::Unfinished::listed)
      internal::system::remove_file(u.path);
}

}  // namespace cullhull

namespace cullhull {

void check_writable(const std::string& path) { const internal::OutputFile unfinished(path); }

void write_text(const std::string& path, std::string_view text) {
  internal::OutputFile file(path);
  file.write(text);
  file.commit();
}

}  // namespace cullhull
