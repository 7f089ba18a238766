#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/settings.hpp"
#include "core/effects/effect.hpp"

namespace teleop {

/// A simulated arm as a plant file gives it: an arm, its electronics and the effects that make it
/// differ from the ideal. The same file serves simulator, scenarios and corrected models.
///
///     arm = "phantom-1.5"
///     [drive]
///     delay_samples = 1
///     [[effect]]
///     kind = "coulomb_friction"
///     axis = 2
///     level = 0.0086
struct PlantSpec {
  struct Sensing {
    bool quantised = true;  ///< joint angles in encoder counts; false: exact
  };
  struct Drive {
    double torque_command_step_Nm = 0.0;  ///< of the digital-to-analogue converter, 0: none
    double max_force_N = 0.0;             ///< of the commanded torques at the tool, 0: no limit
    int delay_samples = 0;                ///< a torque acts so many readings after it was written
  };
  struct Watchdog {
    double timeout_ms = 20.0;  ///< torques are dropped after so long without a write, 0: never
  };
  struct Workspace {
    bool stops = true;  ///< the arm has its joint and coupled stops
  };
  struct Integration {
    double max_step_ms = 1.0;  ///< its error is a thousandth of a count in ten seconds
  };

  std::string arm = "phantom-1.5";
  std::string name{};
  Sensing sensing{};
  Drive drive{};
  Watchdog watchdog{};
  Workspace workspace{};
  Integration integration{};
  std::vector<EffectSpec> effects{};
};

/// Largest PlantSpec::Drive::delay_samples.
inline constexpr int kMaxDelaySamples = 16;

/// Reads a plant file. `name` is a path or the name of a shipped plant ("phantom-1.5").
/// @throws ConfigError naming file and line, and what is allowed there.
[[nodiscard]] PlantSpec load_plant(const std::string& name);

/// The same from TOML text, or from the table of that name in it; `file` stands for its name in
/// messages.
[[nodiscard]] PlantSpec parse_plant(std::string_view toml,
                                    const std::string& file,
                                    const std::string& table = {});

/// Every number, switch and name of the plant, and of its effects
///
///     effect.KIND.AXIS.PARAMETER, effect.KIND.PARAMETER where the effect concerns the whole arm;
///
/// the second effect of the same kind and axis is KIND_2 and so on. What a file left out is given
/// its standard value. The plant must not move or lose effects while the settings are used.
void add_settings(Settings& settings, const std::string& prefix, PlantSpec& plant);

/// The plant as TOML that load_plant() reads back to the same plant.
[[nodiscard]] std::string to_toml(const PlantSpec& plant);

}  // namespace teleop
