#include "io/mapped_file.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <cstring>
#include <optional>
#include <system_error>
#include <utility>

#include "io/blocks/block_source.hpp"
#include "io/blocks/read_ahead.hpp"
#include "io/system.hpp"
#include "io/text/lines.hpp"
#include "parallel/memory/memory.hpp"
#include "parallel/threads/parallel.hpp"

namespace cullhull::internal {
namespace {

// Read by a signal handler, so: fixed size, no lock, no allocation. When all slots are in use
// further mappings work, but are not listed.
struct Slot {
  enum State : int { empty, claimed, listed };
  std::atomic<int> state{empty};
  std::atomic<const char*> begin{nullptr};
  std::atomic<const char*> end{nullptr};
  char name[1024] = {};
};
static_assert(std::atomic<const char*>::is_always_lock_free &&
              std::atomic<int>::is_always_lock_free);

constinit std::array<Slot, 64> slots;

int list_mapping(const Source& source) {
  for (std::size_t i = 0; i < slots.size(); ++i) {
    Slot& s = slots[i];
    int expected = Slot::empty;
    if (!s.state.compare_exchange_strong(expected, Slot::claimed)) continue;
    s.begin = source.data;
    s.end = source.data + source.size;
    const std::size_t length = std::min(source.name.size(), sizeof s.name - 1);
    std::memcpy(s.name, source.name.data(), length);
    s.name[length] = 0;
    s.state.store(Slot::listed, std::memory_order_release);
    return static_cast<int>(i);
  }
  return -1;
}

[[noreturn]] void refuse(const std::string& name, const char* doing, int error) {
  throw Error(ErrorCode::io, name, ": ", doing, ": ", std::generic_category().message(error));
}

/// The memory that a mapped file's size is compared with.
std::uint64_t room() {
  const std::uint64_t memory = machine_memory();
  return memory > 0 ? memory : std::uint64_t{1} << 32;
}

/// `source`: what came of a stream that exceeds the limit.
[[noreturn]] void refuse_stream(Source source, std::size_t size, ReadLimit* limit) {
  source.size = size;
  if (limit == nullptr)
    throw Error(ErrorCode::out_of_budget, source.name, ": more than ", size >> 20,
                " MiB from a stream; write it to a file, which is read in place");
  limit->set_in_blocks(comes_in_blocks(source, {}));
  limit->refuse(size);
}

}  // namespace

MappedFile::MappedFile(const std::string& path, const ReadOptions& options) {
  source_.name = display_name(path);
  std::optional<ReadAhead> ahead = take_read_ahead(path);
  if (ahead || path == "-") {
    read_stream(ahead ? ahead->bytes : std::string(),
                ahead ? ahead->file.get() : system::standard_input, options);
    return;
  }
  const int fd = system::open_to_read(path.c_str());
  if (fd < 0) refuse(source_.name, "cannot open", errno);
  try {
    system::FileStatus status{};
    if (system::status_of(fd, status) != 0) refuse(source_.name, "cannot read", errno);
    if (system::is_folder(status)) refuse(source_.name, "cannot read", EISDIR);
    if (system::is_regular(status) && status.st_size > 0) {
      map(fd, static_cast<std::size_t>(status.st_size));
    } else {
      // Pipes, devices, and files in /proc, which have size 0 but contents.
      read_stream({}, fd, options);
      system::close_file(fd);
    }
  } catch (...) {
    system::close_file(fd);
    throw;
  }
}

void MappedFile::map(int descriptor, std::size_t size) {
  const void* const address = system::map_file(descriptor, 0, size, false);
  if (address == nullptr) refuse(source_.name, "cannot map", errno);
  source_.data = static_cast<const char*>(address);
  source_.size = size;
  descriptor_ = descriptor;
  mapped_ = true;
  system::expect_in_order(address, size);
  slot_ = list_mapping(source_);
}

// Where the array grows, page tables are moved (RawArray) and new pages take memory when they are
// written: the bytes of the stream are all that is needed at any time.
void MappedFile::read_stream(const std::string& ahead, int descriptor, const ReadOptions& options) {
  ReadLimit* const limit = ReadLimit::current();
  const std::uint64_t most = limit != nullptr ? limit->left() : room() / 2;
  constexpr std::size_t first = std::size_t{1} << 16;
  std::size_t size = ahead.size(), capacity = std::max(first, size);
  stream_.reserve(capacity);
  std::copy_n(ahead.data(), size, stream_.data());
  for (;;) {
    if (size > most) refuse_stream(source_, size, limit);
    if (size == capacity) stream_.reserve(capacity *= 2);
    do {
      if (options.stop.stop_requested()) throw Error(ErrorCode::cancelled, "cancelled");
    } while (!system::readable_soon(descriptor));
    constexpr std::size_t piece = std::size_t{1} << 20;  // so that a stop is noticed
    const std::ptrdiff_t got =
        system::read_some(descriptor, stream_.data() + size, std::min(piece, capacity - size));
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) refuse(source_.name, "cannot read", errno);
    if (got == 0) break;
    size += static_cast<std::size_t>(got);
    source_.data = stream_.data();
  }
  source_.data = stream_.data();
  source_.size = size;
  if (size == 0) fail(source_, "empty file");
  if (limit != nullptr) limit->take(size);
}

MappedFile::MappedFile(MappedFile&& other) noexcept { *this = std::move(other); }

MappedFile& MappedFile::operator=(MappedFile&& other) noexcept {
  std::swap(source_, other.source_);
  std::swap(stream_, other.stream_);
  std::swap(descriptor_, other.descriptor_);
  std::swap(slot_, other.slot_);
  std::swap(mapped_, other.mapped_);
  return *this;
}

MappedFile::~MappedFile() {
  if (!mapped_) return;
  if (slot_ >= 0) slots[static_cast<std::size_t>(slot_)].state.store(Slot::empty);
  system::unmap_file(source_.data, source_.size);
  system::close_file(descriptor_);
}

void MappedFile::check_size() const {
  if (!mapped_) return;
  system::FileStatus status{};
  if (system::status_of(descriptor_, status) != 0) refuse(source_.name, "cannot read", errno);
  if (static_cast<std::uint64_t>(status.st_size) < source_.size)
    throw Error(ErrorCode::io, source_.name, ": shrank while it was being read");
}

void MappedFile::prefault(const std::byte* from, std::uint64_t bytes,
                          const ReadOptions& options) const {
  if (!mapped_ || source_.size > room() / 4) return;
  constexpr std::uint64_t piece = std::uint64_t{16} << 20, page = std::uint64_t{64} << 10;
  const auto before =
      static_cast<std::uint64_t>(from - reinterpret_cast<const std::byte*>(source_.data));
  const std::uint64_t first = std::min<std::uint64_t>(before, source_.size) / page * page;
  const std::uint64_t last = std::min<std::uint64_t>(before + bytes, source_.size);
  for_each_chunk(last - first, piece, resolve_threads(options.threads),
                 [&](std::uint64_t, std::uint64_t begin, std::uint64_t end) {
    check_stop(options);
    // A hint: old kernels refuse it, and pages are then faulted in on access.
    system::fetch_pages(source_.data + first + begin, end - begin);
  });
}

FileWindow::FileWindow(const std::string& path) {
  source_.name = display_name(path);
  if (path == "-") return;
  descriptor_ = system::open_to_read(path.c_str());
  if (descriptor_ < 0) refuse(source_.name, "cannot open", errno);
  system::FileStatus status{};
  if (system::status_of(descriptor_, status) == 0 && system::is_regular(status) &&
      status.st_size > 0) {
    size_ = static_cast<std::uint64_t>(status.st_size);
    return;
  }
  system::close_file(descriptor_);
  descriptor_ = -1;
}

FileWindow::FileWindow(FileWindow&& other) noexcept { *this = std::move(other); }

FileWindow& FileWindow::operator=(FileWindow&& other) noexcept {
  std::swap(source_, other.source_);
  std::swap(address_, other.address_);
  std::swap(mapped_, other.mapped_);
  std::swap(size_, other.size_);
  std::swap(descriptor_, other.descriptor_);
  std::swap(slot_, other.slot_);
  return *this;
}

FileWindow::~FileWindow() {
  unmap();
  if (descriptor_ >= 0) system::close_file(descriptor_);
}

void FileWindow::unmap() noexcept {
  if (slot_ >= 0) slots[static_cast<std::size_t>(slot_)].state.store(Slot::empty);
  slot_ = -1;
  if (address_ != nullptr) system::unmap_file(address_, mapped_);
  address_ = nullptr;
}

const Source& FileWindow::move_to(std::uint64_t offset, std::size_t length) {
  unmap();
  source_.data = nullptr;
  source_.size = length;
  if (length == 0) return source_;
  system::FileStatus status{};
  if (system::status_of(descriptor_, status) != 0) refuse(source_.name, "cannot read", errno);
  if (static_cast<std::uint64_t>(status.st_size) < offset + length)
    throw Error(ErrorCode::io, source_.name, ": shrank while it was being read");
  const std::uint64_t page = system::map_granularity();
  const std::uint64_t begin = offset / page * page;
  mapped_ = static_cast<std::size_t>(offset - begin) + length;
  const void* const address = system::map_file(descriptor_, begin, mapped_, true);
  if (address == nullptr) refuse(source_.name, "cannot map", errno);
  address_ = address;
  source_.data = static_cast<const char*>(address) + (offset - begin);
  slot_ = list_mapping(source_);
  return source_;
}

void FileWindow::expect(std::uint64_t offset, std::size_t length) const {
  system::expect_soon(descriptor_, offset, length);
}

}  // namespace cullhull::internal

namespace cullhull {

const char* describe_mapped_fault(const void* address) noexcept {
  const char* const p = static_cast<const char*>(address);
  for (const internal::Slot& s : internal::slots) {
    if (s.state.load(std::memory_order_acquire) != internal::Slot::listed) continue;
    if (p >= s.begin.load() && p < s.end.load()) return s.name;
  }
  return nullptr;
}

}  // namespace cullhull
