#include "viewer/page.hpp"

#include <algorithm>
#include <cstdint>

#include "viewer/assets.hpp"

namespace cullhull::viewer {
namespace {

/// Length in bytes of the UTF-8 sequence that `text` begins with (RFC 3629); 0 if there is none.
std::size_t utf8_length(std::string_view text) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const unsigned first = byte(0);
  if (first < 0x80) return 1;
  const std::size_t length = first >= 0xF0 ? 4 : first >= 0xE0 ? 3 : 2;
  if (first < 0xC2 || first > 0xF4 || text.size() < length) return 0;
  for (std::size_t i = 1; i < length; ++i)
    if ((byte(i) & 0xC0U) != 0x80) return 0;
  const unsigned second = byte(1);
  const bool overlong = (first == 0xE0 && second < 0xA0) || (first == 0xF0 && second < 0x90);
  const bool beyond = (first == 0xED && second >= 0xA0) || (first == 0xF4 && second >= 0x90);
  return overlong || beyond ? 0 : length;
}

/// Escapes "<", which occurs in JSON only within strings.
std::string json_for_html(const std::string& text) {
  std::string out;
  out.reserve(text.size());
  for (const char c : text)
    if (c == '<')
      out += "\\u003c";
    else
      out += c;
  return out;
}

/// Replaces each {{name}} by what append(name) appends. One pass, so values may contain braces.
template <class Append>
std::string filled(std::string_view frame, const Append& append) {
  std::string out;
  for (;;) {
    const auto open = frame.find("{{");
    out += frame.substr(0, open);
    if (open == std::string_view::npos) return out;
    const auto close = frame.find("}}", open);
    append(frame.substr(open + 2, close - open - 2), out);
    frame.remove_prefix(close + 2);
  }
}

void append_data(const Page& page, std::string& out) {
  for (const Page::Data& d : page.data) {
    out.append("<script id=\"").append(d.id).append("\" type=\"").append(d.type).append("\">");
    out += d.type == "application/json" ? json_for_html(d.text) : d.text;
    out += "</script>\n";
  }
}

}  // namespace

std::string page_text(const Page& page) {
  return filled(assets::page_html, [&](std::string_view place, std::string& out) {
    if (place == "title") out += html_escaped(page.title);
    if (place == "notice" && !page.notice.empty())
      out.append("<!--\n").append(page.notice).append("-->\n");
    if (place == "styles") {
      out += assets::base_css;
      for (const std::string_view style : page.styles) out += style;
    }
    if (place == "body") out += page.body;
    if (place == "data") append_data(page, out);
    if (place == "scripts")
      for (const std::string_view script : page.scripts)
        out.append("<script>\n").append(script).append("</script>\n");
  });
}

std::string html_escaped(std::string_view text) {
  std::string out;
  while (!text.empty()) {
    const std::size_t length = utf8_length(text);
    const char c = text[0];
    if (length == 0 || (c >= 0 && c < ' ') || c == 127)
      out += "\xEF\xBF\xBD";
    else if (c == '<')
      out += "&lt;";
    else if (c == '&')
      out += "&amp;";
    else if (c == '"')
      out += "&quot;";
    else
      out += text.substr(0, length);
    text.remove_prefix(length > 0 ? length : 1);
  }
  return out;
}

std::string base64(std::string_view bytes) {
  static constexpr char digits[] =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  out.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t have = std::min<std::size_t>(3, bytes.size() - i);
    std::uint32_t group = 0;
    for (std::size_t j = 0; j < 3; ++j)
      group = group << 8 | (j < have ? static_cast<unsigned char>(bytes[i + j]) : 0U);
    for (std::size_t j = 0; j < 4; ++j)
      out += j <= have ? digits[group >> (18 - 6 * j) & 63U] : '=';
  }
  return out;
}

}  // namespace cullhull::viewer
