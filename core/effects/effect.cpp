#include "core/effects/effect.hpp"

#include <cmath>

namespace teleop {

std::vector<double> sized(const EffectKind& kind,
                          const EffectTrial& trial,
                          std::span<const double> shares) {
  if (kind.sized != nullptr) return kind.sized(trial, shares);
  std::vector<double> values = trial.front();
  for (std::size_t i = 0; i < values.size(); ++i) {
    const std::optional<double> neutral = kind.parameters[i].neutral;
    if (!neutral) continue;
    values[i] = std::isinf(*neutral) ? values[i] / shares[0]
                                     : *neutral + shares[0] * (values[i] - *neutral);
  }
  return values;
}

std::string_view text_of(Channel channel) noexcept {
  switch (channel) {
    case Channel::actuation:
      return "actuation";
    case Channel::joint:
      return "joint";
    case Channel::load:
      return "load";
    case Channel::sensing:
      return "sensing";
    case Channel::timing:
      return "timing";
    case Channel::environment:
      return "environment";
  }
  return "unknown";
}

}  // namespace teleop
