#pragma once

#include <string>

#include "core/base/settings.hpp"
#include "core/model/dynamics.hpp"

namespace teleop {

/// Carries the arm's own weight: τ = share · N(q) [Cavusoglu 2002, section 3].
/// Thread: any. Loop: step neither allocates, blocks nor throws.
class GravityCompensation {
 public:
  struct Config {
    double share = 1.0;  ///< 1 all of it, 0 none
  };

  /// Keeps a reference: the model must outlive this.
  GravityCompensation(const Config& config, const ArmModel& arm) noexcept
      : config_{config}, arm_{arm} {}

  [[nodiscard]] JointVector step(const JointVector& q) const noexcept {
    return config_.share * gravity_torque(arm_, q);
  }

 private:
  Config config_;
  const ArmModel& arm_;
};

void add_settings(Settings& settings,
                  const std::string& prefix,
                  GravityCompensation::Config& config);

}  // namespace teleop
