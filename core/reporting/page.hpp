#pragma once

#include <string_view>

/// The files that a report page is made of, embedded when the library is built.
namespace teleop::page {

extern const std::string_view kTemplate;       ///< page.html, with {{places}} to fill
extern const std::string_view kStyle;          ///< page.css
extern const std::string_view kScript;         ///< page.js
extern const std::string_view kDygraphs;       ///< dygraph.min.js of Debian's libjs-dygraphs
extern const std::string_view kDygraphsStyle;  ///< dygraph.min.css

}  // namespace teleop::page
