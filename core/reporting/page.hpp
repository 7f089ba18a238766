#pragma once

#include <string_view>

/// The files that a report page is made of, embedded when the library is built.
namespace teleop::page {

extern const std::string_view form;            ///< page.html, with {{places}} to fill
extern const std::string_view style;           ///< page.css
extern const std::string_view script;          ///< page.js
extern const std::string_view dygraphs;        ///< dygraph.min.js of Debian's libjs-dygraphs
extern const std::string_view dygraphs_style;  ///< dygraph.min.css

}  // namespace teleop::page
