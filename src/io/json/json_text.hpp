// Numbers and strings as JSON spells them; docs/formats.md, "JSON", says how.
#pragma once

#include <charconv>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <type_traits>

namespace cullhull::internal {

template <class T>
requires std::is_integral_v<T>
void append_json_number(std::string& out, T value) {
  char text[24];
  const auto r = std::to_chars(text, text + sizeof text, value);
  out.append(text, static_cast<std::size_t>(r.ptr - text));
}

/// The shortest decimal that reads back as the same double. JSON has no numbers that are not
/// finite: they are the strings "inf", "-inf" and "nan".
inline void append_json_number(std::string& out, double value) {
  if (!std::isfinite(value)) {
    out += std::isnan(value) ? "\"nan\"" : value > 0 ? "\"inf\"" : "\"-inf\"";
  } else if (value == 0 && std::signbit(value)) {
    out += "-0.0";  // "-0" would read back as an integer, which has no sign
  } else {
    char text[40];
    const auto r = std::to_chars(text, text + sizeof text, value);
    out.append(text, static_cast<std::size_t>(r.ptr - text));
  }
}

/// The number of bytes of the first UTF-8 character of `text`; 0 if it does not begin with one.
inline std::size_t utf8_length(std::string_view text) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const unsigned lead = byte(0);
  if (lead < 0x80) return 1;
  if (lead < 0xC2 || lead > 0xF4) return 0;
  const std::size_t length = lead < 0xE0 ? 2 : lead < 0xF0 ? 3 : 4;
  if (text.size() < length) return 0;
  for (std::size_t i = 1; i < length; ++i)
    if ((byte(i) & 0xC0U) != 0x80) return 0;
  const unsigned second = byte(1);  // no longer than needed, no surrogate, at most U+10FFFF
  const bool bad = (lead == 0xE0 && second < 0xA0) || (lead == 0xED && second > 0x9F) ||
                   (lead == 0xF0 && second < 0x90) || (lead == 0xF4 && second > 0x8F);
  return bad ? 0 : length;
}

/// Each byte that belongs to no character of UTF-8 becomes U+FFFD.
inline void append_json_string(std::string& out, std::string_view text) {
  static constexpr char digits[] = "0123456789abcdef";
  out += '"';
  while (!text.empty()) {
    const std::size_t length = utf8_length(text);
    const char c = text[0];
    if (length == 0) {
      out += "\xEF\xBF\xBD";
    } else if (c == '"' || c == '\\') {
      (out += '\\') += c;
    } else if (length == 1 && static_cast<unsigned char>(c) < ' ') {
      out += "\\u00";
      out += digits[c / 16];
      out += digits[c % 16];
    } else {
      out += text.substr(0, length);
    }
    text.remove_prefix(length == 0 ? 1 : length);
  }
  out += '"';
}

}  // namespace cullhull::internal
