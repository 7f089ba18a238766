#pragma once

#include <filesystem>

namespace teleop {

/// A folder of its own for passing files; it goes with the object.
class Scratch {
 public:
  /// @throws ConfigError when no folder can be made.
  Scratch();
  Scratch(const Scratch&) = delete;
  Scratch& operator=(const Scratch&) = delete;
  Scratch(Scratch&&) = delete;
  Scratch& operator=(Scratch&&) = delete;
  ~Scratch();

  [[nodiscard]] const std::filesystem::path& path() const noexcept { return path_; }

 private:
  std::filesystem::path path_;
};

}  // namespace teleop
