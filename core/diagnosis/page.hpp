#pragma once

#include <string_view>

/// The files that a page about a diagnosis is made of, embedded when the library is built; its
/// looks are those of every report (core/reporting/page.hpp) and a few of its own.
namespace teleop::diagnosis_form {

extern const std::string_view form;   ///< page.html, with {{places}} to fill
extern const std::string_view style;  ///< page.css

}  // namespace teleop::diagnosis_form
