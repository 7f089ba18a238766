#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/base/time.hpp"
#include "core/effects/contact.hpp"
#include "core/effects/hand.hpp"
#include "core/effects/plant_spec.hpp"
#include "core/math/random.hpp"
#include "core/model/arm_model.hpp"
#include "core/ports/arm.hpp"
#include "core/realtime/clock.hpp"
#include "core/simulation/plant.hpp"
#include "core/simulation/sensing.hpp"

namespace teleop {

/// An arm that is computed: a plant behind the port of a device, with the device's electronics.
/// Whenever it is read or written it lets its plant live until clock.now() under the torque that
/// was held, so it runs unchanged on a simulated and on the machine's clock; the same configuration
/// and the same calls at the same instants give the same bits.
///
///   reading   counts to the nearest step; period counter; currents i = τ / (N k_t); the true force
///             on the tool; casing temperatures where the plant's motors heat, acceleration of the
///             tool where it carries an accelerometer.
///   writing   force limit (direction kept), torque limit of each motor, converter step; then held,
///             from the same instant or from a whole number of readings later.
///   time      the plant's time is the clock's times the effect time_base.
///   watchdog  longer than its timeout without a write: torques are dropped, Fault::device_watchdog
///             until the amplifiers have been off.
///
/// At most kLongestGap is computed at once; what a longer pause leaves out is in skipped().
class SimulatedArm final : public Arm {
 public:
  enum class FaultKind : std::uint8_t {
    unplugged,       ///< no answer and no torque from then on
    frozen_encoder,  ///< counts of one axis stand still
    nan_angle,       ///< the angle of one axis reads as not a number
  };
  struct InjectedFault {
    FaultKind kind = FaultKind::unplugged;
    Duration at{};         ///< since the start
    std::size_t axis = 0;  ///< 0 to 2
  };

  struct Config {
    PlantSpec plant{};
    std::string hand = "none";  ///< as for make_hand()
    Hand::Config hand_impedance{};
    std::optional<Contact> contact{};
    std::vector<InjectedFault> faults{};
    std::uint64_t seed = 1;  ///< of everything random: hand "reach", noise of the accelerometer
    JointVector q = JointVector::Zero();  ///< where it starts, at rest
  };

  /// What a real arm would not tell. Positions and forces in B.
  struct Truth {
    JointVector q = JointVector::Zero();
    JointVector qd = JointVector::Zero();
    JointVector torque = JointVector::Zero();     ///< delivered by the motors, N m
    JointVector winding_C = JointVector::Zero();  ///< where the motors heat
    Vector3 p_BT = Vector3::Zero();
    Vector3 v_BT = Vector3::Zero();
    Vector3 hand_force = Vector3::Zero();
    Vector3 contact_force = Vector3::Zero();
  };

  static constexpr Duration kLongestGap{100'000'000};

  /// @throws ConfigError: the arm, an effect, the hand or the posture cannot be had.
  SimulatedArm(const Config& config, Clock& clock);

  [[nodiscard]] const ArmInfo& info() const noexcept override { return info_; }
  [[nodiscard]] ArmState read() noexcept override;
  void write(const JointVector& tau) noexcept override;
  void amplifiers(bool on) noexcept override;

  /// As of the last call of the port.
  [[nodiscard]] Truth true_state() noexcept;

  /// Time that passed on the clock and not in the plant.
  [[nodiscard]] Duration skipped() const noexcept { return skipped_; }

  [[nodiscard]] const ArmModel& model() const noexcept { return model_; }

 private:
  SimulatedArm(const Config& config, Clock& clock, const ArmModel& model, const PlantTerms& terms);

  void live_until(Instant now) noexcept;
  void drive_motors() noexcept;
  void read_motors(ArmState& state) noexcept;
  void read_accelerometer(ArmState& state) noexcept;
  [[nodiscard]] JointVector limited(const JointVector& tau) noexcept;
  void inject_faults(ArmState& state) noexcept;
  [[nodiscard]] bool is_due(const InjectedFault& fault) const noexcept;

  Config config_;
  ArmModel model_;
  Plant plant_;
  Sensing sensing_;
  AccelerometerTerms accelerometer_;
  double time_ratio_;
  Random noise_;
  ArmInfo info_;
  JointVector current_per_torque_;
  Clock* clock_;
  Instant started_;
  Instant now_;
  Instant last_write_;
  Duration watchdog_;
  Duration skipped_{0};

  std::array<JointVector, static_cast<std::size_t>(kMaxDelaySamples) + 1> written_{};
  JointVector motor_torque_ = JointVector::Zero();
  bool on_ = false;
  bool starved_ = false;
  bool unplugged_ = false;
  bool cut_ = false;
  Vector3 felt_ = Vector3::Zero();  ///< acceleration behind the accelerometer's filter
  ArmState last_{};
};

}  // namespace teleop
