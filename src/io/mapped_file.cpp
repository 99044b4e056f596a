#include "io/mapped_file.hpp"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <cstring>
#include <system_error>
#include <utility>

#include "parallel/machine_memory.hpp"
#include "parallel/parallel.hpp"

#if defined(__linux__) && !defined(MADV_POPULATE_READ)
#define MADV_POPULATE_READ 22  // Linux 5.14: the C library's headers may be older than the kernel
#endif

namespace cullhull {
namespace internal {
namespace {

// Read by a signal handler, so: fixed size, no lock, no allocation. Mappings beyond the last slot
// work, they only cannot be named.
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
  throw Error(ErrorCode::io, name + ": " + doing + ": " + std::system_category().message(error));
}

/// Memory that a file may be held against.
std::uint64_t room() {
  const std::uint64_t memory = machine_memory();
  return memory > 0 ? memory : std::uint64_t{1} << 32;
}

}  // namespace

MappedFile::MappedFile(const std::string& path) {
  source_.name = display_name(path);
  if (path == "-") {
    read_stream(STDIN_FILENO);
    return;
  }
  const int fd = open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (fd < 0) refuse(source_.name, "cannot open", errno);
  try {
    struct stat status {};
    if (fstat(fd, &status) != 0) refuse(source_.name, "cannot read", errno);
    if (S_ISDIR(status.st_mode)) refuse(source_.name, "cannot read", EISDIR);
    if (S_ISREG(status.st_mode) && status.st_size > 0) {
      map(fd, static_cast<std::size_t>(status.st_size));
    } else {
      // Pipes, devices, and files of /proc, which have no size but do have content.
      read_stream(fd);
      close(fd);
    }
  } catch (...) {
    close(fd);
    throw;
  }
}

void MappedFile::map(int descriptor, std::size_t size) {
  void* address = mmap(nullptr, size, PROT_READ, MAP_PRIVATE, descriptor, 0);
  if (address == MAP_FAILED) refuse(source_.name, "cannot map", errno);
  source_.data = static_cast<const char*>(address);
  source_.size = size;
  descriptor_ = descriptor;
  mapped_ = true;
  (void)madvise(address, size, MADV_SEQUENTIAL);  // a hint: may fail
  slot_ = list_mapping(source_);
}

void MappedFile::read_stream(int descriptor) {
  const std::uint64_t limit = room() / 2;
  std::size_t capacity = std::size_t{1} << 16, size = 0;
  stream_ = Buffer(capacity);
  for (;;) {
    if (size == capacity) {
      if (capacity > limit / 2)
        throw Error(ErrorCode::out_of_budget,
                    source_.name + ": more than " + std::to_string(capacity >> 20) +
                        " MiB from a stream; write it to a file, which is read in place");
      Buffer larger(2 * capacity);
      std::memcpy(larger.data(), stream_.data(), size);
      stream_ = std::move(larger);
      capacity *= 2;
    }
    const ssize_t got = read(descriptor, stream_.data() + size, capacity - size);
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) refuse(source_.name, "cannot read", errno);
    if (got == 0) break;
    size += static_cast<std::size_t>(got);
  }
  source_.data = stream_.as<const char>();
  source_.size = size;
  if (size == 0) fail(source_, "empty file");
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
  munmap(const_cast<char*>(source_.data), source_.size);
  close(descriptor_);
}

void MappedFile::check_size() const {
  if (!mapped_) return;
  struct stat status {};
  if (fstat(descriptor_, &status) != 0) refuse(source_.name, "cannot read", errno);
  if (static_cast<std::uint64_t>(status.st_size) < source_.size)
    throw Error(ErrorCode::io, source_.name + ": shrank while it was being read");
}

void MappedFile::prefault(unsigned threads) const {
#ifdef MADV_POPULATE_READ
  if (!mapped_ || source_.size > room() / 4) return;
  constexpr std::uint64_t piece = std::uint64_t{16} << 20;
  for_each_chunk(source_.size, piece, resolve_threads(threads),
                 [&](std::uint64_t, std::uint64_t begin, std::uint64_t end) {
                   // A hint: an old kernel refuses it, and pages are then faulted in as touched.
                   (void)madvise(const_cast<char*>(source_.data) + begin, end - begin,
                                 MADV_POPULATE_READ);
                 });
#else
  (void)threads;
#endif
}

FileWindow::FileWindow(const std::string& path) {
  source_.name = display_name(path);
  if (path == "-") return;
  descriptor_ = open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (descriptor_ < 0) refuse(source_.name, "cannot open", errno);
  struct stat status {};
  if (fstat(descriptor_, &status) == 0 && S_ISREG(status.st_mode) && status.st_size > 0) {
    size_ = static_cast<std::uint64_t>(status.st_size);
    return;
  }
  close(descriptor_);
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
  if (descriptor_ >= 0) close(descriptor_);
}

void FileWindow::unmap() noexcept {
  if (slot_ >= 0) slots[static_cast<std::size_t>(slot_)].state.store(Slot::empty);
  slot_ = -1;
  if (address_ != nullptr) munmap(address_, mapped_);
  address_ = nullptr;
}

const Source& FileWindow::move_to(std::uint64_t offset, std::size_t length) {
  unmap();
  source_.data = nullptr;
  source_.size = length;
  if (length == 0) return source_;
  struct stat status {};
  if (fstat(descriptor_, &status) != 0) refuse(source_.name, "cannot read", errno);
  if (static_cast<std::uint64_t>(status.st_size) < offset + length)
    throw Error(ErrorCode::io, source_.name + ": shrank while it was being read");
  const auto page = static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE));
  const std::uint64_t begin = offset / page * page;
  mapped_ = static_cast<std::size_t>(offset - begin) + length;
  int flags = MAP_PRIVATE;
#ifdef MAP_POPULATE
  flags |= MAP_POPULATE;
#endif
  void* address = mmap(nullptr, mapped_, PROT_READ, flags, descriptor_, static_cast<off_t>(begin));
  if (address == MAP_FAILED) refuse(source_.name, "cannot map", errno);
  address_ = address;
  source_.data = static_cast<const char*>(address) + (offset - begin);
  slot_ = list_mapping(source_);
  return source_;
}

void FileWindow::expect(std::uint64_t offset, std::size_t length) const {
#ifdef POSIX_FADV_WILLNEED
  // A hint: whether it is taken changes nothing but time.
  (void)posix_fadvise(descriptor_, static_cast<off_t>(offset), static_cast<off_t>(length),
                      POSIX_FADV_WILLNEED);
#else
  (void)offset, (void)length;
#endif
}

}  // namespace internal

const char* describe_mapped_fault(const void* address) noexcept {
  const char* const p = static_cast<const char*>(address);
  for (const internal::Slot& s : internal::slots) {
    if (s.state.load(std::memory_order_acquire) != internal::Slot::listed) continue;
    if (p >= s.begin.load() && p < s.end.load()) return s.name;
  }
  return nullptr;
}

}  // namespace cullhull
