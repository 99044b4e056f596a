#include "io/blocks/byte_stream.hpp"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <optional>
#include <system_error>

#include "cullhull/error.hpp"
#include "io/blocks/read_ahead.hpp"
#include "io/packed/unpack.hpp"
#include "io/records.hpp"
#include "io/source.hpp"
#include "io/system.hpp"

namespace cullhull::internal {
namespace {

constexpr std::size_t head_bytes = std::size_t{1} << 20;

[[noreturn]] void refuse(const std::string& name, const char* doing, int error) {
  throw Error(ErrorCode::io, name, ": ", doing, ": ", std::generic_category().message(error));
}

/// Reads a descriptor from its present position.
class FileBytes : public ByteStream {
 public:
  FileBytes(std::string name, int fd, bool waits, stop_token stop)
      : name_(std::move(name)), fd_(fd), waits_(waits), stop_(std::move(stop)) {}
  std::size_t read(char* out, std::size_t size) override {
    std::size_t have = 0;
    while (have < size) {
      wait();
      const std::ptrdiff_t got = system::read_some(fd_, out + have, size - have);
      if (got < 0 && errno == EINTR) continue;
      if (got < 0) refuse(name_, "cannot read", errno);
      if (got == 0) break;
      have += static_cast<std::size_t>(got);
    }
    taken_ += have;
    return have;
  }
  std::uint64_t taken() const override { return taken_; }
  /// Counts bytes that another reader took before.
  void count_taken(std::uint64_t bytes) { taken_ += bytes; }

 private:
  /// A pipe may be idle for long: checks now and then whether to stop.
  void wait() const {
    if (!waits_) return;
    do {
      if (stop_.stop_requested()) throw Error(ErrorCode::cancelled, "cancelled");
    } while (!system::readable_soon(fd_));
  }

  std::string name_;
  int fd_;
  bool waits_;
  stop_token stop_;
  std::uint64_t taken_ = 0;
};

/// Puts back bytes that were taken from a stream; keeps the stream's file open.
class WithHead : public ByteStream {
 public:
  WithHead(Descriptor file, std::unique_ptr<ByteStream> rest, std::string head)
      : file_(std::move(file)), rest_(std::move(rest)), head_(std::move(head)) {}
  std::size_t read(char* out, std::size_t size) override {
    const std::size_t first = std::min(size, head_.size() - at_);
    std::memcpy(out, head_.data() + at_, first);
    at_ += first;
    if (at_ > 0 && at_ == head_.size()) {  // its memory may be a large part of the limit
      std::string().swap(head_);
      at_ = 0;
    }
    return first < size ? first + rest_->read(out + first, size - first) : first;
  }
  std::uint64_t taken() const override { return rest_->taken(); }

 private:
  Descriptor file_;
  std::unique_ptr<ByteStream> rest_;
  std::string head_;
  std::size_t at_ = 0;
};

/// A part of a file that may be read anywhere.
class PartBytes : public ByteStream {
 public:
  PartBytes(OpenedBytes&& file, std::uint64_t offset, std::uint64_t size)
      : file_(std::move(file)), at_(offset), left_(size) {}
  std::size_t read(char* out, std::size_t size) override {
    const std::size_t got = std::min<std::uint64_t>(size, left_);
    read_at(file_, out, got, at_);
    at_ += got;
    left_ -= got;
    return got;
  }
  std::uint64_t taken() const override { return at_; }

 private:
  OpenedBytes file_;
  std::uint64_t at_, left_;
};

/// Replaces the stream of a file by another one, and reads its beginning.
void replace_stream(OpenedBytes& opened, std::unique_ptr<ByteStream> stream) {
  opened.head.resize(head_bytes);
  opened.head.resize(stream->read(opened.head.data(), head_bytes));
  if (opened.head.empty()) fail({opened.name, nullptr, 0}, "empty file");
  opened.stream = std::make_unique<WithHead>(Descriptor(), std::move(stream), opened.head);
}

Descriptor another(const Descriptor& file, const std::string& name) {
  Descriptor copy(system::duplicate(file.get()));
  if (copy.get() < 0) refuse(name, "cannot open", errno);
  return copy;
}

/// Replaces an archive by one of its arrays.
OpenedBytes open_member(OpenedBytes&& archive, const std::string& member) {
  if (archive.file.get() < 0)
    throw Error(ErrorCode::invalid_argument, archive.name,
                ": an .npz is read in blocks from a file alone: its directory is "
                "at its end");
  const ReadAt read = [&archive](char* out, std::size_t size, std::uint64_t offset) {
    read_at(archive, out, size, offset);
  };
  const ArchiveMember found = find_member(read, archive.size, member, archive.name);
  OpenedBytes opened;
  opened.name = archive.name;
  if (!member.empty()) opened.name.append(1, ':').append(display_name(member));
  opened.format = "npy";
  opened.size = found.size;
  if (!found.deflated) {
    opened.file = another(archive.file, archive.name);
    opened.base = found.offset;
  }
  std::unique_ptr<ByteStream> stream =
      std::make_unique<PartBytes>(std::move(archive), found.offset, found.packed_size);
  if (found.deflated)
    stream = inflate_member(std::move(stream), found.size, found.crc, opened.name);
  replace_stream(opened, std::move(stream));
  return opened;
}

}  // namespace

Descriptor::~Descriptor() {
  if (fd_ > 0) system::close_file(fd_);
}

namespace {

OpenedBytes open_file(const std::string& path, const stop_token& stop) {
  OpenedBytes opened;
  opened.name = display_name(path);
  opened.size = unknown_size;
  std::optional<ReadAhead> ahead = take_read_ahead(path);
  Descriptor file =
      ahead ? std::move(ahead->file)
            : Descriptor(path == "-" ? system::standard_input : system::open_to_read(path.c_str()));
  if (file.get() < 0) refuse(opened.name, "cannot open", errno);
  system::FileStatus status{};
  if (system::status_of(file.get(), status) != 0) refuse(opened.name, "cannot read", errno);
  if (system::is_folder(status)) refuse(opened.name, "cannot read", EISDIR);
  const bool regular = system::is_regular(status);
  // Files in /proc have size 0, and standard input may be a file that others read, too.
  const bool anywhere = !ahead && path != "-" && regular && status.st_size > 0;
  auto bytes = std::make_unique<FileBytes>(opened.name, file.get(), !regular, stop);
  if (anywhere) {
    // The head is read beside the stream, which need not repeat it: of a thousand tiles, each is
    // opened by one thread while the others wait.
    opened.size = static_cast<std::uint64_t>(status.st_size);
    system::expect_in_order(file.get());
    opened.file = another(file, opened.name);
    opened.head.resize(std::min<std::uint64_t>(head_bytes, opened.size));
    read_at(opened, opened.head.data(), opened.head.size(), 0);
    opened.stream = std::make_unique<WithHead>(std::move(file), std::move(bytes), "");
    return opened;
  }
  if (ahead) {
    opened.head = std::move(ahead->bytes);
    bytes->count_taken(opened.head.size());
  } else {
    opened.head.resize(head_bytes);
    opened.head.resize(bytes->read(opened.head.data(), head_bytes));
  }
  if (opened.head.empty()) fail({opened.name, nullptr, 0}, "empty file");
  system::enlarge_pipe(file.get());  // fails where it is no pipe
  opened.stream = std::make_unique<WithHead>(std::move(file), std::move(bytes), opened.head);
  return opened;
}

}  // namespace

OpenedBytes open_bytes(const std::string& path, const ReadOptions& options) {
  const InputName input = split_input(path);
  OpenedBytes opened = open_file(input.file, options.stop);
  if (is_archive(input.file, opened.head, options))
    return open_member(std::move(opened), input.member);
  const Packing packing = packing_of(opened.head, opened.name, options);
  if (packing == Packing::none) return opened;
  opened.file = Descriptor();
  opened.size = unknown_size;
  replace_stream(opened, unpack(packing, std::move(opened.stream), opened.name));
  return opened;
}

bool read_more_of_head(OpenedBytes& opened) {
  const std::size_t had = opened.head.size();
  std::unique_ptr<ByteStream> stream = std::move(opened.stream);
  opened.head.resize(2 * had);
  opened.head.resize(stream->read(opened.head.data(), opened.head.size()));
  opened.stream = std::make_unique<WithHead>(Descriptor(), std::move(stream), opened.head);
  return opened.head.size() > had;
}

void read_at(const OpenedBytes& from, char* out, std::size_t size, std::uint64_t offset) {
  offset += from.base;
  while (size > 0) {
    const std::ptrdiff_t got = system::read_some_at(from.file.get(), out, size, offset);
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) refuse(from.name, "cannot read", errno);
    if (got == 0) throw Error(ErrorCode::io, from.name, ": shrank while it was being read");
    out += got;
    offset += static_cast<std::uint64_t>(got);
    size -= static_cast<std::size_t>(got);
  }
}

}  // namespace cullhull::internal
