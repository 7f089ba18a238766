#pragma once

#include <map>
#include <string>
#include <string_view>

namespace teleop {

/// Replaces each {{name}} of a page's form by its text, in one pass: what is filled in is never
/// read again. @pre every name is among the places
[[nodiscard]] std::string fill_form(std::string_view form,
                                    const std::map<std::string, std::string, std::less<>>& places);

/// A sentence as HTML in which no number is parted from its unit.
[[nodiscard]] std::string sentence_html(const std::string& sentence);

}  // namespace teleop
