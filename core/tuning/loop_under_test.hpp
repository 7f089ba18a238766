#pragma once

#include <array>
#include <vector>

#include "core/estimation/velocity_estimator.hpp"
#include "core/math/joint_vector.hpp"
#include "core/math/spatial.hpp"
#include "core/ports/arm.hpp"
#include "core/tuning/experiment.hpp"

namespace teleop {

/// The law of an experiment at a gain that may change from tick to tick, for one arm or two; the
/// rest of what moves the arms is with it: weak loops on the other axes, gravity, a push.
///
/// Weak loops are u = −K d − B ḋ with ḋ the first difference behind 20 Hz, slow enough to leave
/// structural modes alone. Thread: the loop's only. Loop: step is allocation-free and noexcept.
class LoopUnderTest {
 public:
  struct Command {
    double gain = 0.0;
    double push_N = 0.0;        ///< on the first arm, its opposite on the second
    bool hold_axis = false;     ///< the weak loop acts on the axis under test as well
    double most_force_N = 0.0;  ///< along the axis; more is cut
  };

  /// What a tick saw and did.
  struct Turn {
    std::array<Vector3, kMostArms> displacement{};  ///< of each tool from its pose, m
    std::array<double, kMostArms> force_N{};        ///< along the axis, as commanded
    std::array<JointVector, kMostArms> torque_Nm{};
    bool cut = false;  ///< some force was over the limit
  };

  /// @throws ConfigError when an estimator cannot be had. @pre one frame an arm.
  LoopUnderTest(const ExperimentConfig& config, const std::vector<ToolFrame>& frames);

  /// @param dt seconds since the last turn, measured.
  Turn step(const std::array<ArmState, kMostArms>& arms,
            const Command& command,
            double dt) noexcept;

  /// Forgets the past of the estimators, as after a pause.
  void reset() noexcept;

  [[nodiscard]] std::size_t arms() const noexcept { return sides_.size(); }
  [[nodiscard]] const ToolFrame& frame(std::size_t arm) const noexcept { return sides_[arm].frame; }
  [[nodiscard]] const ExperimentConfig& config() const noexcept { return config_; }
  void set_hold(double stiffness_N_per_m, double damping_Ns_per_m) noexcept;

 private:
  struct Motion {
    double x = 0.0;
    double v = 0.0;
  };
  static constexpr std::size_t kMostDelay = 16;
  struct Side {
    ToolFrame frame{};
    VelocityEstimator law_velocity;
    DifferenceVelocity hold_velocity;
    std::array<Motion, kMostDelay + 1> motion{};  ///< newest first
    Vector3 rate = Vector3::Zero();
  };

  void sense(Side& side, const ArmState& arm, double dt) noexcept;
  [[nodiscard]] double law(std::size_t arm, double gain) const noexcept;

  ExperimentConfig config_;
  Eigen::Index axis_;
  std::vector<Side> sides_;
};

}  // namespace teleop
