#pragma once

#include <string>
#include <string_view>

namespace teleop {

/// Text that HTML shows as it is, in an element or in a quoted attribute.
[[nodiscard]] std::string escape_html(std::string_view text);

}  // namespace teleop
