// A file as bytes: mapped where it is a regular file, else read into memory.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

#include "io/source.hpp"
#include "parallel/memory/raw_array.hpp"

namespace cullhull::internal {

/// MAP_PRIVATE, read only. While it lives it is listed for describe_mapped_fault().
class MappedFile {
 public:
  MappedFile() = default;
  /// "-" is standard input. Throws Error{io} where the system refuses, Error{bad_file} for an empty
  /// file; for a stream Error{out_of_budget} if it does not fit this thread's ReadLimit, without
  /// one half of the memory, and Error{cancelled} if a stop is requested while it is idle.
  explicit MappedFile(const std::string& path, const ReadOptions& options = {});
  MappedFile(MappedFile&& other) noexcept;
  MappedFile& operator=(MappedFile&& other) noexcept;
  ~MappedFile();

  const Source& source() const noexcept { return source_; }
  bool mapped() const noexcept { return mapped_; }
  /// The bytes of memory that a stream takes.
  std::size_t held() const noexcept { return mapped_ ? 0 : source_.size; }
  /// Error{io} if the file has shrunk since it was opened.
  void check_size() const;
  /// Fills the page tables for the bytes of the file within [from, from + bytes), so that
  /// the first pass over the points need not. Skipped for files that would evict other data from
  /// memory. Options used: threads, stop.
  void prefault(const std::byte* from, std::uint64_t bytes, const ReadOptions& options) const;

 private:
  void map(int descriptor, std::size_t size);
  void read_stream(const std::string& ahead, int descriptor, const ReadOptions& options);

  Source source_;
  RawArray<char> stream_;
  int descriptor_ = -1;
  int slot_ = -1;
  bool mapped_ = false;
};

/// A regular file of any size, accessed through one mapped window at a time: it may exceed address
/// space and memory. The window is listed for describe_mapped_fault().
class FileWindow {
 public:
  FileWindow() = default;
  /// Leaves the object closed if `path` is no regular file with content.
  explicit FileWindow(const std::string& path);
  FileWindow(FileWindow&& other) noexcept;
  FileWindow& operator=(FileWindow&& other) noexcept;
  ~FileWindow();

  bool is_open() const noexcept { return descriptor_ >= 0; }
  std::uint64_t size() const noexcept { return size_; }
  /// Moves the window to [offset, offset + length) and reads its pages; the old contents are
  /// unmapped. Throws Error{io} if the file has shrunk.
  const Source& move_to(std::uint64_t offset, std::size_t length);
  /// Tells the system which part will be read next.
  void expect(std::uint64_t offset, std::size_t length) const;

 private:
  void unmap() noexcept;

  Source source_;
  const void* address_ = nullptr;
  std::size_t mapped_ = 0;
  std::uint64_t size_ = 0;
  int descriptor_ = -1;
  int slot_ = -1;
};

}  // namespace cullhull::internal
