// A file as bytes: mapped where it is a regular file, read into memory where it is a stream.
#pragma once

#include <cstddef>
#include <string>

#include "io/source.hpp"

namespace cullhull::internal {

/// MAP_PRIVATE, read only. While it lives it is listed for describe_mapped_fault().
class MappedFile {
 public:
  MappedFile() = default;
  /// "-" is standard input. Throws Error{io} where the system refuses, Error{bad_file} for an empty
  /// file, Error{out_of_budget} for a stream that does not fit half of the memory.
  explicit MappedFile(const std::string& path);
  MappedFile(MappedFile&& other) noexcept;
  MappedFile& operator=(MappedFile&& other) noexcept;
  ~MappedFile();

  const Source& source() const noexcept { return source_; }
  bool mapped() const noexcept { return mapped_; }
  /// Error{io} if the file has shrunk since it was opened.
  void check_size() const;
  /// Fills the page tables, so that the first pass over the points does not pay for it. Skipped for
  /// files that would push other things out of memory.
  void prefault(unsigned threads) const;

 private:
  void map(int descriptor, std::size_t size);
  void read_stream(int descriptor);

  Source source_;
  Buffer stream_;
  int descriptor_ = -1;
  int slot_ = -1;
  bool mapped_ = false;
};

}  // namespace cullhull::internal
