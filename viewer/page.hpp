// Self-contained HTML pages: one file that needs no network and no other files. Callers provide a
// body, styles, scripts and data.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace cullhull::viewer {

struct Page {
  std::string title;
  std::string_view body;  ///< HTML
  /// Inserted in this order, after assets::base_css. CSS must not contain "</style", scripts not
  /// "</script".
  std::vector<std::string_view> styles;
  std::vector<std::string_view> scripts;
  /// A comment at the top: the licence of the scripts' sources.
  std::string_view notice;

  /// Data that scripts read by document.getElementById(id).textContent.
  struct Data {
    std::string_view id;
    std::string_view type;  ///< a MIME type that is not a script, such as "application/json"
    std::string text;  ///< "<" in JSON is escaped here; other types must not contain "</script"
  };
  std::vector<Data> data;
};

/// The text of the page. Its content security policy forbids all requests.
std::string page_text(const Page& page);

/// `text` (any bytes) as HTML text: invalid UTF-8 becomes U+FFFD.
std::string html_escaped(std::string_view text);

/// Base64, standard alphabet, padded.
std::string base64(std::string_view bytes);

}  // namespace cullhull::viewer
