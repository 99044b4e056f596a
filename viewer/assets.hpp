// The files of viewer/assets/ and three.js, embedded at build time (viewer/CMakeLists.txt).
#pragma once

#include <string_view>

namespace cullhull::viewer::assets {

extern const std::string_view page_html;  ///< the outline of every page, with {{placeholders}}
extern const std::string_view base_css;   ///< colours, type, tables: every page
extern const std::string_view view_html, view_css;
extern const std::string_view data_js, cells_js, colours_js, shadow_js, axes_js, camera_js;
extern const std::string_view stage_js;
extern const std::string_view panel_js, tools_js, view_js;
extern const std::string_view report_html, report_css, report_js;
extern const std::string_view three_licence_txt;
extern const std::string_view three_js;  ///< empty if it was not found

}  // namespace cullhull::viewer::assets
