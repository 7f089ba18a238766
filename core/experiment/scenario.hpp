#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "core/base/settings.hpp"
#include "core/effects/contact.hpp"
#include "core/effects/hand.hpp"
#include "core/effects/plant_spec.hpp"
#include "core/experiment/experiment.hpp"

namespace teleop {

/// A scenario file as it was read.
struct ScenarioText {
  std::string toml{};
  std::string file{};  ///< its name in messages
};

/// @param name a path, or the name of a file of the catalogue without ".toml".
/// @throws ConfigError when it cannot be read.
[[nodiscard]] ScenarioText read_scenario(const std::string& name);

/// A value that replaces what the file says, as TOML would write it (strings may stay bare).
struct Override {
  std::string key{};
  std::string value{};
  std::string origin{};  ///< for messages: "--set", "stiffness.toml:12"
};

/// One experiment with everything that it needs, from one TOML file:
///
///     experiment = "teleop"
///     seed = 1
///     plant = "phantom-1.5"          # a plant file or a shipped plant,
///     [plant]                        # or the same written here, with [[plant.effect]] tables
///     [law]
///     stiffness_master_N_per_m = 800
///     [run]
///     seconds = 10
///
/// Which keys there are depends on the experiment and on the effects of the plant. Made once and
/// checked whole; constant from then on.
class Scenario {
 public:
  /// @throws ConfigError naming file, line and what is allowed: not TOML, an unknown key, a wrong
  ///         type, a value out of range, or values that together cannot be run.
  explicit Scenario(const ScenarioText& text, const std::vector<Override>& overrides = {});
  Scenario(const Scenario&) = delete;
  Scenario& operator=(const Scenario&) = delete;
  Scenario(Scenario&&) = delete;
  Scenario& operator=(Scenario&&) = delete;
  ~Scenario() = default;

  [[nodiscard]] const ExperimentKind& kind() const noexcept { return *kind_; }
  [[nodiscard]] const std::string& name() const noexcept { return name_; }
  [[nodiscard]] const std::string& text() const noexcept { return text_; }
  [[nodiscard]] const std::string& device() const noexcept { return device_; }
  [[nodiscard]] std::uint64_t seed() const noexcept { return seed_; }
  [[nodiscard]] const PlantSpec& plant() const noexcept { return plant_; }
  [[nodiscard]] const PlantSpec& slave_plant() const noexcept { return slave_plant_; }

  /// Prefix of the keys that the slave's plant comes from: its own, else those of the one plant.
  [[nodiscard]] std::string slave_plant_key() const {
    return slave_has_own_ ? "slave_plant." : "plant.";
  }

  /// Every key with its value, meaning and origin.
  [[nodiscard]] const Settings& settings() const noexcept { return settings_; }

  /// The arm is computed, on simulated time.
  [[nodiscard]] bool simulated() const noexcept { return device_ == "sim"; }

  [[nodiscard]] Results run(ExperimentContext& context) const {
    return experiment_->run(*this, context);
  }

  /// Refuses the value of a key where it was set.
  /// @throws ConfigError always: "FILE:LINE: KEY = VALUE: WHY".
  [[noreturn]] void refuse(const std::string& key, const std::string& why) const;

 private:
  void choose_experiment(const ScenarioText& text, const std::vector<Override>& overrides);
  void choose_plants(const ScenarioText& text, const std::vector<Override>& overrides);

  std::string experiment_name_;
  std::string name_;
  std::string text_;
  std::string device_ = "sim";
  std::uint64_t seed_ = 1;
  PlantSpec plant_{};
  PlantSpec slave_plant_{};
  bool slave_has_own_ = false;
  const ExperimentKind* kind_ = nullptr;
  std::unique_ptr<Experiment> experiment_;
  Settings settings_;
};

/// What touches a simulated arm from outside, as far as the integrator has to keep up with it.
struct Surroundings {
  std::optional<Hand> hand{};
  std::optional<Contact> contact{};
};

/// Refuses a plant whose integrator cannot keep up with its fastest part: the classical Runge–Kutta
/// method of order 4 is stable on the real axis as long as step × rate ≤ 2.785
/// [Hairer 1996, section IV.2].
/// `prefix` is that of the plant's keys.
/// @throws ConfigError naming integration.max_step_ms and the longest step that will do.
void check_integrator(const Scenario& scenario,
                      const PlantSpec& plant,
                      const std::string& prefix,
                      const Surroundings& surroundings);

}  // namespace teleop
