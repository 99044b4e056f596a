// Bytes that come one after the other: of a file, a pipe, or what a decompressor makes of one.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <stop_token>
#include <string>
#include <vector>

#include "cullhull/io.hpp"

namespace cullhull::internal {

/// An open file descriptor. 0 stays open.
class Descriptor {
 public:
  explicit Descriptor(int fd = -1) : fd_(fd) {}
  Descriptor(Descriptor&& other) noexcept : fd_(other.fd_) { other.fd_ = -1; }
  Descriptor& operator=(Descriptor&& other) noexcept {
    std::swap(fd_, other.fd_);
    return *this;
  }
  ~Descriptor();
  int get() const { return fd_; }

 private:
  int fd_;
};

class ByteStream {
 public:
  virtual ~ByteStream() = default;
  /// Fills `out` as far as there is something; fewer bytes only at the end. Throws Error{io}, and
  /// Error{bad_file} for what is not compressed as its name says.
  virtual std::size_t read(char* out, std::size_t size) = 0;
  /// Bytes of the file behind it that have been taken so far, for progress.
  virtual std::uint64_t taken() const = 0;
};

/// What has been opened, with its beginning at hand.
struct OpenedBytes {
  std::string name;  ///< for messages
  Descriptor file;   ///< where it is a regular file that is not compressed, for reading anywhere
  std::uint64_t base = 0;              ///< where in it the bytes begin, in an archive
  std::uint64_t size = 0;              ///< of them; unknown_size else
  std::string format;                  ///< where what it lies in tells: "npy"
  std::unique_ptr<ByteStream> stream;  ///< all bytes from the first
  std::string head;                    ///< the first MiB or, if fewer, all
};

/// "-" is standard input; FILE.npz:NAME an array in an archive. What is compressed is unpacked.
/// Throws Error{io}, Error{bad_file} for an empty file; and Error{cancelled}, here and where it is
/// read, while a pipe has nothing and `options.stop` is requested.
OpenedBytes open_bytes(const std::string& path, const ReadOptions& options);

/// Reads at an offset as much as is asked for. Throws Error{io}, also where the file has shrunk.
void read_at(const OpenedBytes& from, char* out, std::size_t size, std::uint64_t offset);

}  // namespace cullhull::internal
