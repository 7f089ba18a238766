#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <type_traits>
#include <vector>

#include "core/base/fault.hpp"
#include "core/base/settings.hpp"
#include "core/control/computed_torque.hpp"
#include "core/control/limiter.hpp"
#include "core/estimation/velocity_estimator.hpp"
#include "core/experiment/experiment.hpp"
#include "core/model/arm_model.hpp"
#include "core/ports/arm.hpp"
#include "core/realtime/clock.hpp"
#include "core/realtime/loop.hpp"
#include "core/recording/tick_record.hpp"

namespace teleop {

/// What a law of an experiment sees in one turn.
struct ArmTurn {
  double t_s = 0.0;  ///< since this stretch began
  JointVector q = JointVector::Zero();
  JointVector qd = JointVector::Zero();  ///< estimated
};

/// One arm on its loop for an experiment: simulated time where the scenario computes the arm, real
/// time where the program opened one; the same code and the same port. Bounds on speed and torque
/// hold in every turn; a fault of the arm ends the stretch and, from then on, all others at once.
/// The destructor leaves torques at zero and amplifiers off.
///
/// Thread: one. Loop: a turn allocates nothing and cannot throw.
class ArmRig {
 public:
  struct Config {
    double rate_Hz = 1000.0;
    double max_joint_speed_rad_per_s = 20.0;  ///< beyond it a fault
    Limiter::Config limits{};
    VelocityEstimator::Config velocity{};
    ComputedTorque::Config servo{};  ///< moves the arm between stretches
  };

  /// How a stretch ended.
  enum class Ending : std::uint8_t { time_over, law_ended, fault, stopped };

  /// Simulates the scenario's plant unless the context has an arm.
  /// @throws ConfigError when an arm or a part's configuration cannot be used.
  ArmRig(const Config& config, const Scenario& scenario, const ExperimentContext& context);
  ArmRig(const ArmRig&) = delete;
  ArmRig& operator=(const ArmRig&) = delete;
  ArmRig(ArmRig&&) = delete;
  ArmRig& operator=(ArmRig&&) = delete;
  ~ArmRig();

  /// Runs a law for so long: law(const ArmTurn&) gives the joint torques, or nothing to end.
  template <class Law>
  Ending run(double length_s, Law&& law) noexcept {
    static_assert(std::is_nothrow_invocable_r_v<std::optional<JointVector>, Law&, const ArmTurn&>);
    Ending ending = fault_ == Fault::none ? Ending::time_over : Ending::fault;
    if (ending == Ending::fault) return ending;
    clock_.sleep_until(next_);
    const Instant start = clock_.now();
    const double end_s = length_s - 0.5 * seconds(period_);
    run_periodically(clock_, period_, [&](const Tick& tick) noexcept {
      next_ = tick.now + period_;
      sense(tick, start);
      if (turn_.t_s > end_s && fault_ == Fault::none) return Next::stop;
      const bool told = context_.stopped();
      const std::optional<JointVector> tau =
          fault_ != Fault::none || told ? std::nullopt : std::optional<JointVector>{law(turn_)};
      if (!tau) {
        ending = fault_ != Fault::none ? Ending::fault : told ? Ending::stopped : Ending::law_ended;
        if (ending != Ending::law_ended) go_limp();
        return Next::stop;
      }
      act(*tau, seconds(tick.elapsed));
      remember(tick);
      return Next::again;
    });
    return ending;
  }

  /// Takes the arm to a posture along a straight line of joints and the path of least jerk, then
  /// holds it there for `settle_s`.
  Ending move_to(const JointVector& q, double length_s, double settle_s) noexcept;

  [[nodiscard]] const ArmModel& model() const noexcept { return model_; }
  [[nodiscard]] const JointVector& q() const noexcept { return turn_.q; }
  [[nodiscard]] Fault fault() const noexcept { return fault_; }

  /// From now on every turn that acts is written down, as far as `tape` has room reserved; null:
  /// no longer.
  void record_to(std::vector<TickRecord>* tape) noexcept { tape_ = tape; }

  /// Turns in which a limit shortened the torque.
  [[nodiscard]] std::uint64_t cut_turns() const noexcept { return cut_turns_; }

 private:
  void sense(const Tick& tick, Instant start) noexcept;
  void act(const JointVector& tau, double dt) noexcept;
  void go_limp() noexcept;
  void remember(const Tick& tick) noexcept;

  Config config_;
  const ExperimentContext& context_;
  SimulatedClock simulated_clock_;
  std::unique_ptr<Arm> simulated_arm_;
  Clock& clock_;
  Arm& arm_;
  ArmModel model_;
  Duration period_;
  VelocityEstimator velocity_;
  Limiter limiter_;
  ComputedTorque servo_;
  Instant next_;
  ArmTurn turn_{};
  ArmState state_{};
  JointVector tau_ = JointVector::Zero();  ///< last written
  std::vector<TickRecord>* tape_ = nullptr;
  Fault fault_ = Fault::none;
  bool on_ = false;
  std::uint64_t cut_turns_ = 0;
};

/// The keys rate_Hz, velocity., limits. and servo.
void add_settings(Settings& settings, ArmRig::Config& config);

}  // namespace teleop
