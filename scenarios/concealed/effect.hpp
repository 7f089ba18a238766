#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace teleop::concealed {

/// One thing that a concealed device does and its nominal model does not. The kinds are those of
/// the answer format and, with names that begin with `oov_`, devices that no kind describes.
struct Effect {
  std::string kind{};
  std::optional<std::size_t> axis{};  ///< 0 to 2; none: the whole arm. 1 to 3 in files
  std::vector<std::pair<std::string, double>> parameters{};  ///< in the order of the format, SI
  bool training_only = false;  ///< not there in the run that is held back

  /// @throws ConfigError when there is none of that name
  [[nodiscard]] double at(std::string_view name) const;
  [[nodiscard]] double& at(std::string_view name);
};

/// What the generator knows of a kind.
struct Kind {
  std::string_view name{};
  std::string_view channel{};  ///< of the answer format; "unknown" outside the vocabulary
  bool per_axis = true;
};

[[nodiscard]] std::span<const Kind> vocabulary() noexcept;
/// Devices that the vocabulary does not describe.
[[nodiscard]] std::span<const Kind> strangers() noexcept;
/// @throws ConfigError when the name is in neither.
[[nodiscard]] const Kind& find_kind(std::string_view name);

}  // namespace teleop::concealed
