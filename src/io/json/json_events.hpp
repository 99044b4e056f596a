// Reads a JSON text (RFC 8259) as a row of events: one pass over memory, no document, no recursion.
// What is open takes one bit a level, so that no nesting is too deep.
#pragma once

#include <charconv>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

#include "io/json/json_text.hpp"
#include "io/text/text_scan.hpp"

namespace cullhull::internal {

/// Calls the handler's functions, each of which returns whether to go on:
///
///     null()  boolean(bool)  string(std::string_view)  key(std::string_view)
///     number_unsigned(std::uint64_t)                   integers without a sign below 2^64
///     number_integer(std::int64_t)                     negative ones from -2^63 on
///     number_float(double, std::string_view text)      all others, correctly rounded
///     start_object()  end_object()  start_array()  end_array()
///     fault(const char* at, std::string_view why)      after which nothing is read
///     at(const char*)                                  before each event: where its text begins
///
/// Strings are UTF-8 with their escapes resolved, and last as long as the call.
template <class Handler>
class JsonEvents {
 public:
  JsonEvents(const char* begin, const char* end, Handler& handler)
      : p_(begin), end_(end), handler_(handler) {}

  /// Reads one value: true at its end, false where the handler stopped.
  bool read() {
    constexpr std::string_view byte_order_mark = "\xEF\xBB\xBF";
    if (rest().substr(0, byte_order_mark.size()) == byte_order_mark) p_ += byte_order_mark.size();
    do {
      if (!value()) return false;
    } while (!behind_value_ || close());
    return done_;
  }
  /// The same; the text must end there.
  bool read_all() {
    if (!read()) return false;
    skip_space();
    return p_ == end_ || fault(p_);
  }
  /// Where the next text begins.
  const char* next() const { return p_; }

 private:
  std::string_view rest() const { return {p_, static_cast<std::size_t>(end_ - p_)}; }
  bool fault(const char* at) {
    const bool number = at < end_ && (*at == 'N' || *at == 'I');
    return fault(at,
                 number ? "not valid JSON, which has no NaN and no infinity" : "not valid JSON");
  }
  bool fault(const char* at, std::string_view why) {
    handler_.fault(at, why);
    return false;
  }
  void skip_space() {
    while (p_ < end_ && (*p_ == ' ' || *p_ == '\n' || *p_ == '\r' || *p_ == '\t')) ++p_;
  }
  /// What comes next, after spaces; 0 at the end.
  char peek() {
    skip_space();
    return p_ < end_ ? *p_ : '\0';
  }
  bool take(char c) {
    if (peek() != c) return false;
    handler_.at(p_++);
    return true;
  }

  /// A value, or the beginning of one that has members.
  bool value() {
    const char c = peek();
    handler_.at(p_);
    behind_value_ = true;
    if (c == '-' || is_digit(c)) return number();
    switch (c) {
      case '{':
        return begin(true);
      case '[':
        return begin(false);
      case '"':
        return text() && handler_.string(text_);
      case 't':
        return word("true") && handler_.boolean(true);
      case 'f':
        return word("false") && handler_.boolean(false);
      case 'n':
        return word("null") && handler_.null();
      default:
        return fault(p_);
    }
  }
  bool begin(bool object) {
    ++p_;
    if (!(object ? handler_.start_object() : handler_.start_array())) return false;
    if (take(object ? '}' : ']')) return object ? handler_.end_object() : handler_.end_array();
    open_.push_back(object);
    behind_value_ = false;
    return !object || key();
  }
  bool key() {
    if (peek() != '"') return fault(p_);
    handler_.at(p_);
    if (!text() || !handler_.key(text_)) return false;
    if (peek() != ':') return fault(p_);
    ++p_;
    return true;
  }
  /// Behind a value: whether another one follows. Closes what ends before it.
  bool close() {
    while (!open_.empty()) {
      const bool object = open_.back();
      if (peek() == ',') {
        ++p_;
        return !object || key();
      }
      if (!take(object ? '}' : ']')) return fault(p_);
      open_.pop_back();
      if (!(object ? handler_.end_object() : handler_.end_array())) return false;
    }
    done_ = true;
    return false;
  }

  bool word(std::string_view word) {
    for (const char c : word) {
      if (p_ == end_ || *p_ != c) return fault(p_);
      ++p_;
    }
    return true;
  }
  static const char* skip_digits(const char* p, const char* end) {
    while (p < end && is_digit(*p)) ++p;
    return p;
  }
  bool number() {
    const char* const first = p_;
    const bool negative = *p_ == '-';
    const char* const digits = p_ + (negative ? 1 : 0);
    std::uint64_t whole = 0;  // of 19 digits and less, which cannot overflow
    const char* q = digits;
    if (q < end_ && *q == '0')
      ++q;
    else
      for (; q < end_ && is_digit(*q); ++q) whole = whole * 10 + static_cast<unsigned>(*q - '0');
    if (q == digits) return fault(q);
    p_ = q;
    if (q < end_ && (*q == '.' || *q == 'e' || *q == 'E')) return fraction(first);
    constexpr std::ptrdiff_t safe = 19;
    if (q - digits > safe && std::from_chars(digits, q, whole).ec != std::errc())
      return real(first);
    if (!negative) return handler_.number_unsigned(whole);
    constexpr std::uint64_t limit = std::uint64_t{1} << 63;
    return whole <= limit ? handler_.number_integer(static_cast<std::int64_t>(0 - whole))
                          : real(first);
  }
  bool fraction(const char* first) {
    if (*p_ == '.') {
      const char* const digits = p_ + 1;
      p_ = skip_digits(digits, end_);
      if (p_ == digits) return fault(p_);
    }
    if (p_ < end_ && (*p_ == 'e' || *p_ == 'E')) {
      const char* digits = p_ + 1;
      if (digits < end_ && (*digits == '+' || *digits == '-')) ++digits;
      p_ = skip_digits(digits, end_);
      if (p_ == digits) return fault(p_);
    }
    return real(first);
  }
  bool real(const char* first) {
    double number = 0;
    const char* q = first;
    if (scan_number(q, p_, number) != Scan::ok)
      return fault(first, "a number exceeds the range of doubles");
    return handler_.number_float(number, {first, static_cast<std::size_t>(p_ - first)});
  }

  /// A string into text_: a part of the memory that is read, but where it has escapes.
  bool text() {
    const char* first = ++p_;
    bool escaped = false;
    for (; p_ < end_ && *p_ != '"';) {
      const auto c = static_cast<unsigned char>(*p_);
      if (c == '\\') {
        if (!escaped) unescaped_.clear();
        escaped = true;
        unescaped_.append(first, p_);
        if (!escape()) return false;
        first = p_;
      } else {
        const std::size_t length = c < ' ' ? 0 : c < 0x80 ? 1 : utf8_length(rest());
        if (length == 0) return fault(p_);
        p_ += length;
      }
    }
    if (p_ == end_) return fault(p_);
    text_ = {first, static_cast<std::size_t>(p_ - first)};
    if (escaped) text_ = unescaped_.append(text_);
    ++p_;
    return true;
  }
  bool escape() {
    if (++p_ == end_) return fault(p_);
    constexpr std::string_view letters = "\"\\/bfnrt", meant = "\"\\/\b\f\n\r\t";
    const char letter = *p_;
    if (letter == 'u') return code_point();
    const std::size_t which = letters.find(letter);
    if (which == std::string_view::npos) return fault(p_);
    unescaped_ += meant[which];
    ++p_;
    return true;
  }
  /// Behind the backslash of \uXXXX, of which a pair stands for a character beyond U+FFFF.
  bool code_point() {
    std::uint32_t code = 0, low = 0;
    if (!hex(code)) return false;
    const bool first_half = code >= 0xD800 && code < 0xDC00;
    if (code >= 0xDC00 && code < 0xE000) return fault(p_ - 1);
    if (first_half) {
      if (rest().substr(0, 2) != "\\u") return fault(p_);
      ++p_;
      if (!hex(low)) return false;
      if (low < 0xDC00 || low >= 0xE000) return fault(p_ - 1);
      code = 0x10000 + ((code - 0xD800) << 10) + (low - 0xDC00);
    }
    append_utf8(code);
    return true;
  }
  bool hex(std::uint32_t& code) {
    ++p_;  // the u
    if (end_ - p_ < 4) return fault(end_);
    const char* const stop = p_ + 4;
    const auto r = std::from_chars(p_, stop, code, 16);  // no sign, no 0x
    if (r.ptr != stop) return fault(r.ptr);
    p_ = stop;
    return true;
  }
  void append_utf8(std::uint32_t code) {
    const auto put = [&](std::uint32_t byte) { unescaped_ += static_cast<char>(byte); };
    const auto rest_of = [&](int shift) { put(0x80 | ((code >> shift) & 0x3F)); };
    if (code < 0x80) return put(code);
    if (code < 0x800) {
      put(0xC0 | (code >> 6));
    } else {
      if (code < 0x10000) {
        put(0xE0 | (code >> 12));
      } else {
        put(0xF0 | (code >> 18));
        rest_of(12);
      }
      rest_of(6);
    }
    rest_of(0);
  }

  const char* p_;
  const char* const end_;
  Handler& handler_;
  std::vector<bool> open_;     ///< for each level: an object, not a list
  bool behind_value_ = false;  ///< a value has ended, not begun
  bool done_ = false;
  std::string_view text_;
  std::string unescaped_;
};

}  // namespace cullhull::internal
