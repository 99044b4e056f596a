#include "io/packed/archive.hpp"

#include <algorithm>
#include <cctype>
#include <vector>

#include "io/source.hpp"
#include "io/system.hpp"

namespace cullhull::internal {
namespace {

/// Little-endian fields of bytes whose presence has been checked.
class Fields {
 public:
  explicit Fields(std::string_view bytes) : bytes_(bytes) {}
  std::uint64_t at(std::size_t offset, unsigned size) const {
    std::uint64_t value = 0;
    for (unsigned i = 0; i < size; ++i)
      value |= std::uint64_t{static_cast<unsigned char>(bytes_[offset + i])} << 8 * i;
    return value;
  }

 private:
  std::string_view bytes_;
};

struct Directory {
  std::uint64_t offset = 0, size = 0, entries = 0;
};

class Archive {
 public:
  Archive(const ReadAt& read, std::uint64_t size, std::string name)
      : read_(read), size_(size), name_(std::move(name)) {}

  std::vector<ArchiveMember> members() const {
    const Directory where = find_directory();
    constexpr std::uint64_t most = std::uint64_t{1} << 28;
    if (where.size > most) refuse("a directory of " + std::to_string(where.size) + " bytes");
    const std::string bytes = bytes_at(where.offset, where.size);
    std::vector<ArchiveMember> list;
    std::size_t at = 0;
    for (std::uint64_t i = 0; i < where.entries; ++i) list.push_back(parse_entry(bytes, at));
    return list;
  }

  /// A member's bytes begin after its local header.
  void locate(ArchiveMember& member) const {
    constexpr std::size_t fixed = 30;
    const std::string head = bytes_at(member.offset, fixed);
    if (!head.starts_with("PK\x03\x04"))
      refuse(quoted_text(member.name) + " is not where it should be");
    const Fields f(head);
    const std::uint64_t skip = fixed + f.at(26, 2) + f.at(28, 2);
    if (skip > size_ - member.offset || member.packed_size > size_ - member.offset - skip)
      refuse(quoted_text(member.name) + " does not fit into the file");
    member.offset += skip;
  }

  [[noreturn]] void refuse(const std::string& why) const { fail({name_, nullptr, 0}, why); }

 private:
  std::string bytes_at(std::uint64_t offset, std::uint64_t size) const {
    if (offset > size_ || size > size_ - offset)
      refuse("is cut short, or no archive: it ends at byte " + std::to_string(size_));
    std::string bytes(size, '\0');
    read_(bytes.data(), bytes.size(), offset);
    return bytes;
  }

  /// Finds the end record, which may be followed by a comment, and its 64-bit form.
  Directory find_directory() const {
    constexpr std::uint64_t record = 22, longest = record + 0xFFFF, wide = 0xFFFFFFFF;
    const std::uint64_t tail = std::min(size_, longest);
    const std::string bytes = bytes_at(size_ - tail, tail);
    const std::size_t found = bytes.rfind("PK\x05\x06");
    if (found == std::string::npos || bytes.size() - found < record)
      refuse("is cut short, or no archive: it has no directory at its end");
    const Fields f(std::string_view(bytes).substr(found));
    Directory d{f.at(16, 4), f.at(12, 4), f.at(10, 2)};
    const std::uint64_t end = size_ - tail + found;
    if (d.offset != wide && d.size != wide && d.entries != 0xFFFF) return d;
    if (end < 20) refuse("no directory");
    const std::string locator = bytes_at(end - 20, 20);
    if (!locator.starts_with("PK\x06\x07")) return d;
    const std::string large = bytes_at(Fields(locator).at(8, 8), 56);
    if (!large.starts_with("PK\x06\x06")) refuse("no directory where it should be");
    const Fields w(large);
    return {w.at(48, 8), w.at(40, 8), w.at(32, 8)};
  }

  ArchiveMember parse_entry(const std::string& bytes, std::size_t& at) const {
    constexpr std::size_t fixed = 46;
    if (bytes.size() - at < fixed || bytes.compare(at, 4, "PK\x01\x02") != 0)
      refuse("its directory is cut short or corrupt");
    const Fields f(std::string_view(bytes).substr(at));
    const std::size_t name = f.at(28, 2), extra = f.at(30, 2), comment = f.at(32, 2);
    if (bytes.size() - at - fixed < name + extra + comment)
      refuse("its directory is cut short or corrupt");
    ArchiveMember m;
    m.name = bytes.substr(at + fixed, name);
    m.crc = static_cast<std::uint32_t>(f.at(16, 4));
    m.packed_size = f.at(20, 4);
    m.size = f.at(24, 4);
    m.offset = f.at(42, 4);
    const std::uint64_t method = f.at(10, 2);
    m.deflated = method == 8;
    widen(m, std::string_view(bytes).substr(at + fixed + name, extra));
    at += fixed + name + extra + comment;
    if ((f.at(8, 2) & 1) != 0) refuse(quoted_text(m.name) + " is encrypted");
    if (method != 0 && method != 8)
      refuse(quoted_text(m.name) + " is packed by method " + std::to_string(method) +
             "; 0 (stored) and 8 (deflate) are known");
    if (method == 0 && m.packed_size != m.size) refuse(quoted_text(m.name) + " has two sizes");
    return m;
  }

  /// Replaces the fields that do not fit 32 bits by those of the extra field.
  static void widen(ArchiveMember& m, std::string_view extra) {
    while (extra.size() >= 4) {
      const Fields f(extra);
      const std::size_t size = std::min<std::size_t>(f.at(2, 2), extra.size() - 4);
      if (f.at(0, 2) == 1) {
        std::size_t at = 4;
        for (std::uint64_t* value : {&m.size, &m.packed_size, &m.offset}) {
          if (*value != 0xFFFFFFFF || at + 8 > 4 + size) continue;
          *value = f.at(at, 8);
          at += 8;
        }
      }
      extra.remove_prefix(4 + size);
    }
  }

  const ReadAt& read_;
  std::uint64_t size_;
  std::string name_;
};

std::string without_ending(const std::string& name) {
  return name.ends_with(".npy") ? name.substr(0, name.size() - 4) : name;
}

}  // namespace

InputName split_input(const std::string& path) {
  std::string lower = path;
  for (char& c : lower) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  system::FileStatus status{};
  for (const std::string_view ending : {".npz:", ".h5:", ".hdf5:", ".he5:", ".nc:", ".nc4:"}) {
    const std::size_t found = lower.find(ending);
    if (found == std::string::npos || system::status_of(path.c_str(), status) == 0) continue;
    const std::size_t colon = found + ending.size() - 1;
    return {path.substr(0, colon), path.substr(colon + 1)};
  }
  return {path, ""};
}

bool begins_archive(std::string_view head) {
  return head.starts_with("PK\x03\x04") || head.starts_with("PK\x05\x06");
}

ArchiveMember find_member(const ReadAt& read, std::uint64_t size, const std::string& member,
                          const std::string& name) {
  const Archive archive(read, size, name);
  std::vector<ArchiveMember> arrays = archive.members();
  std::erase_if(arrays, [](const ArchiveMember& m) { return !m.name.ends_with(".npy"); });
  std::string names;
  constexpr std::size_t most = 12;
  for (std::size_t i = 0; i < arrays.size() && i < most; ++i)
    names += (i > 0 ? ", " : "") + quoted_text(without_ending(arrays[i].name));
  if (arrays.size() > most) names += ", ...";
  const auto wanted = std::find_if(arrays.begin(), arrays.end(), [&](const ArchiveMember& m) {
    return m.name == member || without_ending(m.name) == member;
  });
  if (!member.empty() && wanted == arrays.end())
    throw Error(ErrorCode::invalid_argument, name, ": no array ", quoted_text(member),
                "; there are ", (names.empty() ? "none" : names));
  if (arrays.empty()) archive.refuse("an archive without an array (.npy)");
  if (member.empty() && arrays.size() > 1)
    throw Error(ErrorCode::invalid_argument, name, ": holds the arrays ", names,
                "; say which as FILE.npz:NAME");
  ArchiveMember found = member.empty() ? arrays[0] : *wanted;
  archive.locate(found);
  return found;
}

}  // namespace cullhull::internal
