#include "io/source.hpp"

#include <algorithm>
#include <cctype>
#include <new>
#include <utility>

#include "parallel/byte_order.hpp"
#include "parallel/memory/memory.hpp"
#include "parallel/memory/pages.hpp"
#include "parallel/paths.hpp"

namespace cullhull::internal {

namespace {

thread_local ReadLimit* limit_of_thread = nullptr;

}  // namespace

ReadLimit::ReadLimit(std::string name, const ReadOptions& options)
    : name_(std::move(name)),
      budget_(resolve_budget(options.memory_budget)),
      left_(budget_),
      hint_(options.blocks_hint),
      outer_(std::exchange(limit_of_thread, this)) {}
ReadLimit::~ReadLimit() { limit_of_thread = outer_; }
ReadLimit* ReadLimit::current() noexcept { return limit_of_thread; }

void ReadLimit::take(std::uint64_t bytes) {
  if (bytes > left_) refuse(budget_ - left_ + bytes);
  left_ -= bytes;
}

void ReadLimit::refuse(std::uint64_t bytes) const {
  const bool advise = in_blocks_ && hint_ != nullptr;
  throw Error(ErrorCode::out_of_budget, name_, ": its points need more than ", bytes >> 20,
              " MiB, the memory budget is ", size_text(budget_), advise ? "; " : "",
              advise ? hint_ : "");
}

Buffer::Buffer(std::size_t size) {
  constexpr std::size_t huge = std::size_t{2} << 20;
  const std::align_val_t alignment{size >= 4 * huge ? huge : alignof(std::max_align_t)};
  ReadLimit* const limit = ReadLimit::current();
  if (limit != nullptr) limit->take(size);
  data_ = {static_cast<std::byte*>(::operator new(size, alignment)), Free{alignment, size}};
  if (size >= 4 * huge) prefer_huge_pages(data_.get(), size);
}

void Buffer::Free::operator()(std::byte* p) const noexcept {
  ::operator delete(p, alignment);
  if (ReadLimit* const limit = ReadLimit::current(); limit != nullptr) limit->give_back(size);
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
            bool of_columns) {
  if (options.remark) options.remark({source.name, message, of_columns});
}

namespace {

/// Bytes of the character at the beginning of `text` if it can be printed on a line, else 0: no
/// control, and none that separates lines or turns the direction of writing.
std::size_t printable_character(std::string_view text) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const unsigned first = byte(0);
  if (first < 0x80) return first >= ' ' && first <= '~' ? 1 : 0;
  const std::size_t length = first >= 0xF0 ? 4 : first >= 0xE0 ? 3 : 2;
  if (first < 0xC2 || first > 0xF4 || text.size() < length) return 0;
  std::uint32_t code = first & (0xFFU >> (length + 1));
  for (std::size_t i = 1; i < length; ++i) {
    if ((byte(i) & 0xC0U) != 0x80) return 0;
    code = code << 6 | (byte(i) & 0x3FU);
  }
  constexpr std::uint32_t shortest[] = {0, 0, 0x80, 0x800, 0x10000};
  const bool no_character = code < shortest[length] || code > 0x10FFFF ||
                            (code >= 0xD800 && code <= 0xDFFF) || (code & 0xFFFE) == 0xFFFE;
  const bool unprintable = code < 0xA0 || (code >= 0x200B && code <= 0x200F) ||
                           (code >= 0x2028 && code <= 0x202E) ||
                           (code >= 0x2060 && code <= 0x206F) || code == 0xFEFF;
  return no_character || unprintable ? 0 : length;
}

}  // namespace

std::string printable_text(std::string_view text) {
  std::string out;
  while (!text.empty()) {
    const std::size_t length = printable_character(text);
    if (length > 0)
      out += text.substr(0, length);
    else
      out += '?';
    text.remove_prefix(std::max<std::size_t>(length, 1));
  }
  return out;
}

std::string quoted_text(std::string_view text) {
  constexpr std::size_t limit = 40;
  std::size_t cut = std::min(limit, text.size());
  // Not within a character of UTF-8, which has up to three more bytes after its first.
  for (int i = 0; i < 3 && cut > 0 && cut < text.size(); ++i)
    if ((static_cast<unsigned char>(text[cut]) & 0xC0U) == 0x80) --cut;
  return "'" + printable_text(text.substr(0, cut)) + (text.size() > cut ? "...'" : "'");
}

std::string display_name(const std::string& path) {
  if (path == "-") return "standard input";
  std::string out = path;
  for (char& c : out)
    if (static_cast<unsigned char>(c) < ' ' || c == 127) c = '?';
  return out;
}

std::string extension_of(const std::string& path) {
  const std::size_t slash = path.find_last_of(separators);
  const std::size_t dot = path.rfind('.');
  if (dot == std::string::npos || (slash != std::string::npos && dot < slash)) return "";
  std::string out = path.substr(dot + 1);
  for (char& c : out) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return out;
}

}  // namespace cullhull::internal
