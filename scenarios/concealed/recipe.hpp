#pragma once

#include <vector>

#include "scenarios/concealed/device_draw.hpp"
#include "scenarios/concealed/effect_draw.hpp"
#include "scenarios/concealed/plan.hpp"

namespace teleop::concealed {

/// How the case of one slot is made.
struct Recipe {
  struct Part {
    Sized effect;
    double target = 0.0;  ///< detectability that it alone shall have
  };
  DeviceWish wish{};
  std::vector<Part> searched{};  ///< effects whose size is found by search
  std::vector<Effect> fixed{};   ///< effects that are as they are
  bool band_matters = false;     ///< the case shall come out in the band of its slot
};

[[nodiscard]] Recipe draw_recipe(const Slot& slot, const ArmModel& nominal, Random& random);

/// What can be drawn only once the sizes are known: a controller that hides the friction, a bias
/// that cancels a weight.
void complete(const Slot& slot, Device& device);

}  // namespace teleop::concealed
