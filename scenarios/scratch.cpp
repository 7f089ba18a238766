#include "scenarios/scratch.hpp"

#include <string>

#include <stdlib.h>

#include "core/base/error.hpp"

namespace teleop {

namespace fs = std::filesystem;

Scratch::Scratch() {
  std::string name = (fs::temp_directory_path() / "teleop-XXXXXX").string();
  if (mkdtemp(name.data()) == nullptr) throw ConfigError{name + ": cannot be made"};
  path_ = name;
}

Scratch::~Scratch() {
  std::error_code ignored;
  fs::remove_all(path_, ignored);
}

}  // namespace teleop
