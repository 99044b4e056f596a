// std::from_chars and std::to_chars for doubles where the C++ library has none: that of emscripten
// (cmake/wasm_std.hpp). Digits are read by fast_float and made by fmt; the notation is libstdc++'s,
// so that files are the same.
#if defined(__EMSCRIPTEN__)
#include <fast_float/fast_float.h>
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <string>

namespace {

/// d.ddd x 10^power: digits without zeros at either end, a single 0 for zero.
struct Digits {
  std::string text;
  int power = 0;
};

Digits digits_of(double value) {
  const std::string text = fmt::format("{}", value);
  const std::size_t exponent = std::min(text.find('e'), text.size());
  Digits d;
  if (exponent < text.size()) d.power = std::atoi(text.c_str() + exponent + 1);
  const std::size_t point = std::min(text.find('.'), exponent);
  d.power += static_cast<int>(point) - 1;
  for (std::size_t i = 0; i < exponent; ++i)
    if (i != point) d.text += text[i];
  const std::size_t zeros = d.text.find_first_not_of('0');
  if (zeros == std::string::npos) return {"0", 0};
  d.power -= static_cast<int>(zeros);
  d.text = d.text.substr(zeros, d.text.find_last_not_of('0') + 1 - zeros);
  return d;
}

}  // namespace

std::to_chars_result std::to_chars(char* first, char* last, double value, chars_format format) {
  std::string text = std::signbit(value) ? "-" : "";
  const Digits d = digits_of(std::fabs(value));
  const int count = static_cast<int>(d.text.size()), lowest = d.power - count + 1;
  const int one = count == 1 ? 1 : 0;  // without a point, so shorter by one
  const bool fixed =
      format != chars_format::scientific && lowest >= one - count - 3 && lowest <= 5 - one;
  if (!fixed)
    text += fmt::format("{}{}{}e{}{:02}", d.text[0], count > 1 ? "." : "", d.text.substr(1),
                        d.power < 0 ? '-' : '+', std::abs(d.power));
  else if (lowest >= 0)
    text += fmt::format("{:.0f}", std::fabs(value));  // all digits, not those of the shortest alone
  else if (d.power >= 0)
    text += d.text.substr(0, d.power + 1) + "." + d.text.substr(d.power + 1);
  else
    text += "0." + std::string(static_cast<std::size_t>(-d.power - 1), '0') + d.text;
  if (last - first < static_cast<std::ptrdiff_t>(text.size())) return {last, errc::value_too_large};
  return {std::copy(text.begin(), text.end(), first), errc()};
}

std::from_chars_result std::from_chars(const char* first, const char* last, double& value) {
  const auto [end, error] = fast_float::from_chars(first, last, value);
  return {end, error};
}
#endif
