// Members of a ZIP archive, as numpy.savez writes one: FILE.npz:NAME.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>

namespace cullhull::internal {

/// FILE.npz:NAME or FILE.h5:NAME in its two parts; the second is empty for any other name, and
/// where a file with the whole name exists.
struct InputName {
  std::string file, member;
};
InputName split_input(const std::string& path);

struct ArchiveMember {
  std::string name;
  std::uint64_t offset = 0;       ///< of its bytes in the archive
  std::uint64_t packed_size = 0;  ///< their compressed size
  std::uint64_t size = 0;
  std::uint32_t crc = 0;
  bool deflated = false;
};

/// Reads `size` bytes of an archive at `offset`; the range has been checked.
using ReadAt = std::function<void(char* out, std::size_t size, std::uint64_t offset)>;

/// Whether bytes begin as an archive does.
bool begins_archive(std::string_view head);

/// The array `member` (with or without .npy), or the only array, of an archive of `size` bytes.
/// Everything is checked against the archive's size. Throws Error{bad_file} naming `name`;
/// Error{invalid_argument} where there is no such array, or more than one.
ArchiveMember find_member(const ReadAt& read, std::uint64_t size, const std::string& member,
                          const std::string& name);

}  // namespace cullhull::internal
