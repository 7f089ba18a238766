#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "scenarios/scoring/case_truth.hpp"

namespace teleop {

/// An effect that an answer names.
struct GivenEffect {
  struct Value {
    double value = 0.0;
    double deviation = 0.0;  ///< 0: not stated
  };
  struct Alternative {
    EffectName name{};
    double confidence = 0.0;
  };
  EffectName name{};
  double confidence = 0.0;
  std::map<std::string, Value> parameters{};
  std::vector<Alternative> alternatives{};
};

/// An answer as far as it is scored.
struct GivenAnswer {
  std::string verdict{};
  std::vector<int> axes{};
  std::vector<std::string> channels{};
  std::vector<GivenEffect> effects{};  ///< conventions applied, see drop_absorbed()
  std::optional<double> over_floor{};  ///< corrected RMS over the noise floor, as the answer says

  /// Something is said to be missing from the nominal model.
  [[nodiscard]] bool detects() const noexcept {
    return verdict == "explained" || leaves_something();
  }
  /// Something is said to remain that has no name.
  [[nodiscard]] bool leaves_something() const noexcept {
    return verdict == "partly_explained" || verdict == "unexplained";
  }
};

/// Reads an answer (docs/diagnosis.md). What has the wrong type counts as not given; nothing when
/// it is no answer at all.
[[nodiscard]] std::optional<GivenAnswer> read_answer(const nlohmann::json& answer);

}  // namespace teleop
