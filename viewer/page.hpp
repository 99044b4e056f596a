// Self-contained HTML pages: one file, no network, no other files. Whoever has something to show
// (a hull, the figures of a benchmark) gives a body, styles, scripts and data.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace cullhull::viewer {

struct Page {
  std::string title;
  std::string_view body;  ///< HTML
  /// In this order, behind assets::base_css. CSS must not contain "</style", scripts not
  /// "</script".
  std::vector<std::string_view> styles;
  std::vector<std::string_view> scripts;
  /// Put into a comment at the top: the licence of what the scripts come from.
  std::string_view notice;

  /// A script reads it as document.getElementById(id).textContent.
  struct Data {
    std::string_view id;
    std::string_view type;  ///< a MIME type that is no script, "application/json" say
    std::string text;  ///< of JSON "<" is escaped here; other types must not contain "</script"
  };
  std::vector<Data> data;
};

/// The whole file. A policy in its head forbids every request.
std::string page_text(const Page& page);

/// `text` (any bytes) as HTML text: what is no UTF-8 becomes U+FFFD.
std::string html_escaped(std::string_view text);

/// Standard alphabet, padded.
std::string base64(std::string_view bytes);

}  // namespace cullhull::viewer
