#include "core/control/gravity.hpp"

namespace teleop {

void add_settings(Settings& settings,
                  const std::string& prefix,
                  GravityCompensation::Config& config) {
  settings.add(prefix + "share", &config.share, "of the arm's weight that is carried, 0 to 1",
               {.low = 0.0, .high = 1.0});
}

}  // namespace teleop
