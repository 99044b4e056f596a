#include "io/source.hpp"

#include <sys/mman.h>

#include <cctype>
#include <new>

namespace cullhull::internal {

Buffer::Buffer(std::size_t size) {
  constexpr std::size_t huge = std::size_t{2} << 20;
  if (size >= 4 * huge) {
    const std::size_t rounded = (size + huge - 1) / huge * huge;
    if (rounded < size) throw std::bad_alloc();
    data_.reset(static_cast<std::byte*>(std::aligned_alloc(huge, rounded)));
    if (data_) (void)madvise(data_.get(), rounded, MADV_HUGEPAGE);  // a hint: may fail
  } else {
    data_.reset(static_cast<std::byte*>(std::malloc(size > 0 ? size : 1)));
  }
  if (!data_) throw std::bad_alloc();
}

void fail(const Source& source, const std::string& message) {
  throw Error(ErrorCode::bad_file, source.name + ": " + message);
}

void fail_at_line(const Source& source, std::uint64_t line, const std::string& message) {
  throw Error(ErrorCode::bad_file, source.name + ":" + std::to_string(line) + ": " + message);
}

void fail_at_byte(const Source& source, std::uint64_t offset, const std::string& message) {
  throw Error(ErrorCode::bad_file,
              source.name + ": byte " + std::to_string(offset) + ": " + message);
}

std::string quoted_text(std::string_view text) {
  constexpr std::size_t limit = 40;
  std::string out = "'";
  for (const char c : text.substr(0, limit)) out += (c >= ' ' && c <= '~') ? c : '?';
  return out + (text.size() > limit ? "...'" : "'");
}

std::string display_name(const std::string& path) {
  if (path == "-") return "standard input";
  std::string out = path;
  for (char& c : out)
    if (static_cast<unsigned char>(c) < ' ' || c == 127) c = '?';
  return out;
}

std::string extension_of(const std::string& path) {
  const std::size_t slash = path.rfind('/');
  const std::size_t dot = path.rfind('.');
  if (dot == std::string::npos || (slash != std::string::npos && dot < slash)) return "";
  std::string out = path.substr(dot + 1);
  for (char& c : out) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return out;
}

}  // namespace cullhull::internal
