#pragma once

#include <string_view>

namespace teleop {

/// Of the program; the same number as in CMakeLists.txt, held together by a test.
inline constexpr std::string_view kVersion = "0.1.0";

}  // namespace teleop
