#pragma once

#include <string>

namespace teleop::testing {

struct Finished {
  int exit_code = -1;
  std::string output;  ///< standard output and error together
};

/// Runs one of the project's programs ("teleop-master --help") to its end.
[[nodiscard]] Finished run(const std::string& command);

}  // namespace teleop::testing
