// JSON (RFC 8259) as events: strict, without a document or a copy, knowing where it is.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "io/text/text_scan.hpp"

namespace cullhull::internal::inline io {

/// Thrown at a place where the text is not JSON.
struct JsonFault {
  const char* at;
  std::string message;
};

/// A class derives from JsonScanner<itself> and has the functions
///   start_object() end_object() start_array() end_array()
///   key(std::string_view) string(std::string_view) literal(std::string_view)  (true, false, null)
///   bool wants_number(), number(double)
/// which scan() calls in the order of the text. Texts are valid during the call. A number that is
/// not wanted is not converted, and may exceed the range of doubles.
template <class Derived>
class JsonScanner {
 public:
  JsonScanner(const char* begin, const char* end) : p_(begin), end_(end), token_(begin) {}

  /// Throws JsonFault, and what the functions throw.
  void scan() {
    read_value();
    while (!open_.empty()) {
      skip();
      if (take(open_.back() ? '}' : ']')) {
        close();
        continue;
      }
      if (!take(',')) fault();
      if (open_.back()) read_key();
      read_value();
    }
    skip();
    if (p_ != end_) fault();
  }

 protected:
  /// Where the value begins that the current call is about, or its last bracket.
  const char* token() const { return token_; }

 private:
  Derived& self() { return static_cast<Derived&>(*this); }
  [[noreturn]] void fault(const char* message = "not valid JSON") const { fault_at(p_, message); }
  [[noreturn]] static void fault_at(const char* at, const char* message = "not valid JSON") {
    throw JsonFault{at, message};
  }

  void skip() {
    while (p_ < end_ && (*p_ == ' ' || *p_ == '\n' || *p_ == '\r' || *p_ == '\t')) ++p_;
    token_ = p_;
  }
  bool take(char c) {
    if (p_ == end_ || *p_ != c) return false;
    ++p_;
    return true;
  }
  void close() {
    const bool object = open_.back();
    open_.pop_back();
    object ? self().end_object() : self().end_array();
  }

  /// A value without parts; or the beginning of one, up to its first part without parts.
  void read_value() {
    for (;;) {
      skip();
      if (p_ == end_) fault();
      if (*p_ != '[' && *p_ != '{') return read_simple();
      const bool object = *p_++ == '{';
      object ? self().start_object() : self().start_array();
      open_.push_back(object);
      skip();
      if (take(object ? '}' : ']')) return close();
      if (object) read_key();
    }
  }
  void read_simple() {
    switch (*p_) {
      case '"':
        return self().string(read_string());
      case 't':
        return read_literal("true");
      case 'f':
        return read_literal("false");
      case 'n':
        return read_literal("null");
      case 'N':
      case 'I':
        fault("not valid JSON, which has no NaN and no infinity");
      default:
        return read_number();
    }
  }
  void read_literal(std::string_view word) {
    if (!std::string_view(p_, static_cast<std::size_t>(end_ - p_)).starts_with(word)) fault();
    p_ += word.size();
    self().literal(word);
  }
  void read_key() {
    skip();
    if (p_ == end_ || *p_ != '"') fault();
    self().key(read_string());
    skip();
    if (!take(':')) fault();
  }

  void read_digits() {
    if (p_ == end_ || !is_digit(*p_)) fault_at(token_);
    while (p_ < end_ && is_digit(*p_)) ++p_;
  }
  void read_number() {
    if (take('-') && p_ < end_ && *p_ == 'I')
      fault_at(token_, "not valid JSON, which has no NaN and no infinity");
    if (!take('0')) read_digits();
    if (take('.')) read_digits();
    if (take('e') || take('E')) {
      if (!take('+')) take('-');
      read_digits();
    }
    if (!self().wants_number()) return;
    double value = 0;
    const char* p = token_;
    if (scan_number(p, p_, value) == Scan::out_of_range)
      fault_at(token_, "a number exceeds the range of doubles");
    self().number(value);
  }

  /// From its first quote on.
  std::string_view read_string() {
    const char* const begin = ++p_;
    for (;; ++p_) {
      if (p_ == end_) fault();
      if (*p_ == '"') return {begin, static_cast<std::size_t>(p_++ - begin)};
      if (*p_ == '\\') break;
      pass_character();
    }
    text_.assign(begin, p_);
    while (p_ < end_ && *p_ != '"') {
      const char* const from = p_;
      if (take('\\')) {
        read_escape();
      } else {
        pass_character();
        text_.append(from, ++p_);
      }
    }
    if (!take('"')) fault();
    return text_;
  }
  /// Moves to the last byte of a character, which has to be UTF-8 and no control character.
  void pass_character() {
    const auto first = static_cast<unsigned char>(*p_);
    if (first < 0x20) fault();
    if (first < 0x80) return;
    const int more = first >= 0xF0 ? 3 : first >= 0xE0 ? 2 : 1;
    if (first < 0xC2 || first > 0xF4 || end_ - p_ <= more) fault();
    // The second byte excludes what is too long, surrogates, and what is beyond U+10FFFF.
    const auto second = static_cast<unsigned char>(p_[1]);
    if ((first == 0xE0 && second < 0xA0) || (first == 0xED && second > 0x9F) ||
        (first == 0xF0 && second < 0x90) || (first == 0xF4 && second > 0x8F))
      fault();
    for (int i = 1; i <= more; ++i)
      if ((static_cast<unsigned char>(p_[i]) & 0xC0) != 0x80) fault();
    p_ += more;
  }
  void read_escape() {
    constexpr std::string_view letters = "\"\\/bfnrt", meant = "\"\\/\b\f\n\r\t";
    if (p_ == end_) fault();
    if (*p_ != 'u') {
      const std::size_t at = letters.find(*p_);
      if (at == std::string_view::npos) fault();
      ++p_;
      text_ += meant[at];
      return;
    }
    std::uint32_t code = read_code();
    if (code >= 0xDC00 && code < 0xE000) fault();
    if (code >= 0xD800 && code < 0xDC00) {
      if (!take('\\') || p_ == end_ || *p_ != 'u') fault();
      const std::uint32_t low = read_code();
      if (low < 0xDC00 || low >= 0xE000) fault();
      code = 0x10000 + ((code - 0xD800) << 10) + (low - 0xDC00);
    }
    append_utf8(code);
  }
  /// uXXXX
  std::uint32_t read_code() {
    if (end_ - p_ < 5) fault();
    std::uint32_t code = 0;
    for (int i = 1; i <= 4; ++i) {
      const char c = p_[i];
      const int digit = is_digit(c)              ? c - '0'
                        : (c >= 'a' && c <= 'f') ? c - 'a' + 10
                        : (c >= 'A' && c <= 'F') ? c - 'A' + 10
                                                 : -1;
      if (digit < 0) fault();
      code = 16 * code + static_cast<std::uint32_t>(digit);
    }
    p_ += 5;
    return code;
  }
  void append_utf8(std::uint32_t code) {
    const int more = code < 0x80 ? 0 : code < 0x800 ? 1 : code < 0x10000 ? 2 : 3;
    constexpr std::uint32_t marks[] = {0, 0xC0, 0xE0, 0xF0};
    text_ += static_cast<char>(marks[more] | (code >> (6 * more)));
    for (int i = more - 1; i >= 0; --i)
      text_ += static_cast<char>(0x80 | ((code >> (6 * i)) & 0x3F));
  }

  const char* p_;
  const char* const end_;
  const char* token_;
  std::vector<bool> open_;  ///< objects (true) and arrays around the place
  std::string text_;        ///< of a string with escapes
};

}  // namespace cullhull::internal::inline io
