#include "core/control/tool_damping.hpp"

namespace teleop {

void add_settings(Settings& settings, const std::string& prefix, ToolDamping::Config& config) {
  settings.add(prefix + "damping_Ns_per_m", &config.damping_Ns_per_m,
               "local damping of the tool, felt as drag", kNotNegative);
}

}  // namespace teleop
