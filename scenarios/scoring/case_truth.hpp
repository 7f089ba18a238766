#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

namespace teleop {

/// What an effect is called: a kind, and an axis (1 to 3) unless it is of the whole arm.
struct EffectName {
  std::string kind{};
  std::optional<int> axis{};

  [[nodiscard]] bool operator==(const EffectName&) const = default;
};

/// An effect that a device really has.
struct TrueEffect {
  EffectName name{};
  std::map<std::string, double> parameters{};  ///< SI
  bool in_vocabulary = true;
  bool visible_alone = true;  ///< false: one of a pair that nobody could see by itself
};

/// What a device holds, whatever it was drawn as.
enum class Content { nothing, one, several, stranger };

/// The truth of a concealed case, as far as answers are held against it.
struct CaseTruth {
  std::string name{};
  std::string group{};  ///< as it was drawn: "single", "pair", "nasty" …
  std::string sort{};
  double dnr = 0.0;  ///< how much the held-out RMS rises where the effects are left out
  std::vector<TrueEffect> effects{};  ///< conventions applied, see drop_absorbed()
  std::vector<std::string> channels{};

  [[nodiscard]] Content content() const;
};

/// Reads the truth of a case. Where it gives no `dnr_held_out`, the lower end of its band counts.
/// @throws ConfigError when something is missing.
[[nodiscard]] CaseTruth read_truth(const nlohmann::json& truth);

}  // namespace teleop
