// Sequential bytes of a file, of a pipe, or of a decompressor.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
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
  /// Fills `out` as far as bytes are available; fewer only at the end. Throws Error{io}, and
  /// Error{bad_file} for corrupt compressed bytes.
  virtual std::size_t read(char* out, std::size_t size) = 0;
  /// Bytes of the underlying file that were read so far, for progress.
  virtual std::uint64_t taken() const = 0;
};

/// An opened input, with its first bytes.
struct OpenedBytes {
  std::string name;  ///< for messages
  Descriptor file;   ///< where it is a regular file that is not compressed, for reading anywhere
  std::uint64_t base = 0;              ///< offset of the bytes in it (in an archive)
  std::uint64_t size = 0;              ///< of them; unknown_size else
  std::string format;                  ///< if its container determines it: "npy"
  std::unique_ptr<ByteStream> stream;  ///< all bytes from the first
  std::string head;                    ///< the first MiB, or more, or all
};

/// "-" is standard input; FILE.npz:NAME an array in an archive. Compressed files are decompressed.
/// Throws Error{io}, Error{bad_file} for an empty file; and Error{cancelled}, here and when it is
/// read, if `options.stop` is requested while a pipe is idle.
OpenedBytes open_bytes(const std::string& path, const ReadOptions& options);

/// Doubles the length of the head, or takes all there is. False where nothing is left.
bool read_more_of_head(OpenedBytes& opened);

/// Reads exactly `size` bytes at an offset. Throws Error{io}, also where the file has shrunk.
void read_at(const OpenedBytes& from, char* out, std::size_t size, std::uint64_t offset);

}  // namespace cullhull::internal
