#include "io/source.hpp"

#include <algorithm>
#include <cctype>
#include <new>

#include "parallel/byte_order.hpp"
#include "parallel/memory/pages.hpp"

namespace cullhull::internal::inline io {

Buffer::Buffer(std::size_t size) {
  constexpr std::size_t huge = std::size_t{2} << 20;
  const std::align_val_t alignment{size >= 4 * huge ? huge : alignof(std::max_align_t)};
  data_ = {static_cast<std::byte*>(::operator new(size, alignment)), Free{alignment}};
  if (size >= 4 * huge) prefer_huge_pages(data_.get(), size);
}

PointData in_machine_order(PointData data) {
  return little_endian_machine ? std::move(data) : with_reversed_bytes(std::move(data));
}

PointData with_reversed_bytes(PointData data) {
  const PointView from = data.view;
  const std::size_t size = scalar_size(from.scalar);
  if (size == 1) return data;
  Buffer packed(from.count * from.dimension * size);
  std::byte* to = packed.data();
  for (std::uint64_t i = 0; i < from.count; ++i)
    for (std::uint32_t j = 0; j < from.dimension; ++j, to += size)
      std::reverse_copy(from.address(i, j), from.address(i, j) + size, to);
  const auto step = static_cast<std::ptrdiff_t>(size);
  data.view = {packed.data(), from.scalar, from.dimension, from.count, step * from.dimension, step};
  data.storage = std::move(packed);
  data.in_place = false;
  return data;
}

void remark(const Source& source, const ReadOptions& options, const std::string& message,
            Remark::Kind kind) {
  if (options.remark) options.remark({kind, source.name, message});
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

}  // namespace cullhull::internal::inline io
