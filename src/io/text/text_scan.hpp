// Scanning text: lines, words, numbers.
#pragma once

#include <fast_float/fast_float.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <system_error>

namespace cullhull::internal {

inline bool is_blank(char c) {
  return c == ' ' || c == '\t' || c == '\r' || c == '\v' || c == '\f';
}
/// Whether a word is this one of small letters, or the same in capitals.
inline bool is_keyword(std::string_view word, std::string_view small) {
  if (word.size() != small.size()) return false;
  if (word == small) return true;
  for (std::size_t i = 0; i < word.size(); ++i)
    if (word[i] != static_cast<char>(small[i] - 'a' + 'A')) return false;
  return true;
}
inline bool is_digit(char c) { return c >= '0' && c <= '9'; }

inline const char* skip_blanks(const char* p, const char* end) {
  while (p < end && is_blank(*p)) ++p;
  return p;
}

/// The number of line ends. Bytes are counted in rows of bytes, which compilers make vectors of: a
/// fifth of the time of std::count.
inline std::uint64_t count_line_ends(const char* p, std::size_t size) {
  constexpr std::size_t width = 64, most = 255;
  std::uint64_t all = 0;
  while (size >= width) {
    std::uint8_t sums[width] = {};
    const std::size_t rows = std::min(size / width, most);
    for (std::size_t r = 0; r < rows; ++r, p += width)
      for (std::size_t j = 0; j < width; ++j)
        sums[j] = static_cast<std::uint8_t>(sums[j] + (p[j] == '\n' ? 1 : 0));
    for (const std::uint8_t sum : sums) all += sum;
    size -= rows * width;
  }
  return all + static_cast<std::uint64_t>(std::count(p, p + size, '\n'));
}

/// '#' or '//'.
inline bool is_comment(const char* p, const char* end) {
  return p < end && (*p == '#' || (*p == '/' && p + 1 < end && p[1] == '/'));
}

/// The line's first run of characters that are not blank.
inline std::string_view first_word(const char* p, const char* end) {
  p = skip_blanks(p, end);
  const char* q = p;
  while (q < end && !is_blank(*q)) ++q;
  return {p, static_cast<std::size_t>(q - p)};
}

/// Lines of [begin, end) without their '\n'.
class LineScanner {
 public:
  LineScanner(const char* begin, const char* end) : next_(begin), stop_(end) {}
  bool next() {
    if (next_ >= stop_) return false;
    begin_ = next_;
    const void* newline = std::memchr(begin_, '\n', static_cast<std::size_t>(stop_ - begin_));
    end_ = newline != nullptr ? static_cast<const char*>(newline) : stop_;
    next_ = newline != nullptr ? end_ + 1 : stop_;
    ++number_;
    return true;
  }
  const char* begin() const { return begin_; }
  const char* end() const { return end_; }
  const char* rest() const { return next_; }        ///< first character of the line after
  std::uint64_t number() const { return number_; }  ///< of the current line, from 1

 private:
  const char* begin_ = nullptr;
  const char* end_ = nullptr;
  const char* next_;
  const char* stop_;
  std::uint64_t number_ = 0;
};

enum class Scan { ok, not_a_number, out_of_range };

/// Reads one number at p, correctly rounded, and advances p. "nan" and "inf" are numbers (the
/// library refuses them later, by index); overflow is out of range, underflow is rounded like any
/// other number. `decimal`: '.' or ','. The caller checks what follows.
inline Scan scan_number(const char*& p, const char* end, double& value, char decimal = '.') {
  const char* q = p;
  if (q < end && *q == '+') {
    ++q;
    if (q >= end || !(is_digit(*q) || *q == decimal)) return Scan::not_a_number;
  }
  const auto r = decimal == '.'
                     ? fast_float::from_chars(q, end, value)
                     : fast_float::from_chars_advanced(
                           q, end, value,
                           fast_float::parse_options(fast_float::chars_format::general, decimal));
  // Some versions report underflow as an error although the value is set, and do not report
  // overflow.
  if (r.ec != std::errc() && !(r.ec == std::errc::result_out_of_range && std::fabs(value) < 1))
    return r.ec == std::errc::result_out_of_range ? Scan::out_of_range : Scan::not_a_number;
  if (std::isinf(value)) {
    const char first = *q == '-' ? q[1] : *q;
    if (is_digit(first) || first == decimal) return Scan::out_of_range;
  }
  p = r.ptr;
  return Scan::ok;
}

/// A whole non-negative decimal integer.
inline bool parse_unsigned(std::string_view word, std::uint64_t& value) {
  if (word.empty() || word.size() > 19) return false;
  value = 0;
  for (const char c : word) {
    if (!is_digit(c)) return false;
    value = value * 10 + static_cast<std::uint64_t>(c - '0');
  }
  return true;
}

bool is_obj_keyword(std::string_view word);

}  // namespace cullhull::internal
