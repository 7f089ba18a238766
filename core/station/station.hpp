#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/control/computed_torque.hpp"
#include "core/control/gravity.hpp"
#include "core/control/limiter.hpp"
#include "core/control/position_error.hpp"
#include "core/control/supervisor.hpp"
#include "core/control/tool_damping.hpp"
#include "core/estimation/velocity_estimator.hpp"
#include "core/model/arm_model.hpp"
#include "core/ports/arm.hpp"
#include "core/ports/link.hpp"
#include "core/realtime/clock.hpp"
#include "core/realtime/loop.hpp"
#include "core/recording/log.hpp"
#include "core/recording/tick_record.hpp"

namespace teleop {

/// How one side of the pair behaves.
struct StationConfig {
  double rate_Hz = 1000.0;
  PositionError::Config law{};
  ToolDamping::Config damping{};
  GravityCompensation::Config gravity{};
  bool computed_torque = false;  ///< the slave follows by computed torque, not by a force
  ComputedTorque::Config tracking{};
  double hold_stiffness_N_per_m = 0.0;  ///< holds the tool's place while holding; 0: not
  VelocityEstimator::Config velocity{};
  Supervisor::Config supervisor{};
  Limiter::Config limits{};
  double max_joint_speed_rad_per_s = 60.0;  ///< beyond it a fault
  bool engage_at_start = true;
};

void add_settings(Settings& settings, const std::string& prefix, StationConfig& config);

/// One side's turn: read → think → write → send, and the record of it. It knows three ports, Arm,
/// Link and Clock, so the same code runs on hardware over UDP and on simulated time.
///
/// Thread: the loop's only, but for the constructor. Loop: step and stop neither allocate, block
/// nor throw.
class Station {
 public:
  struct Ports {
    Arm& arm;
    Link& link;
    Clock& clock;
  };

  /// Keeps references: model and ports must outlive it.
  /// @throws ConfigError when a part's configuration cannot be used.
  Station(const StationConfig& config, Role role, const ArmModel& model, const Ports& ports);

  /// @returns what this turn saw and did; valid until the next one.
  const TickRecord& step(const Tick& tick) noexcept;

  /// Torques zero, amplifiers off, the peer told. @returns the record of that: the last turn's,
  /// without torque.
  const TickRecord& stop() noexcept;

  /// Shows a failed recording as a fault in the record; the turns go on.
  void report_recording_failed() noexcept { recording_failed_ = true; }

  [[nodiscard]] const LinkStatistics& link_statistics() const noexcept { return statistics_; }

  /// What a reader of the recording needs of the law, for its metadata.
  [[nodiscard]] Metadata metadata() const;

  /// What a user should know before the loop starts, a line each.
  [[nodiscard]] std::vector<std::string> notices() const;

 private:
  /// What this turn knows of the own arm.
  struct Own {
    ArmState arm{};
    JointVector qd = JointVector::Zero();
    Matrix3 J = Matrix3::Zero();  ///< J_v
    Vector3 p = Vector3::Zero();
    Vector3 v = Vector3::Zero();
  };

  void sense(const Tick& tick) noexcept;
  void hear() noexcept;
  [[nodiscard]] bool clutched() const noexcept;
  [[nodiscard]] Fault check() const noexcept;
  void supervise(const Tick& tick, Fault fault) noexcept;
  [[nodiscard]] JointVector think(double dt) noexcept;
  [[nodiscard]] Vector3 couple() noexcept;
  [[nodiscard]] Vector3 follow(const PositionError::Motion& peer) const noexcept;
  [[nodiscard]] Vector3 hold() const noexcept;
  void tell(const Tick& tick) noexcept;
  void remember(const Tick& tick, const JointVector& tau) noexcept;
  void remember_peer(const PeerSample& sample, const Tick& tick) noexcept;

  StationConfig config_;
  Role role_;
  const ArmModel& model_;
  Arm& arm_;
  Link& link_;
  Clock& clock_;
  PositionError law_;
  ToolDamping damping_;
  GravityCompensation gravity_;
  ComputedTorque tracking_;
  VelocityEstimator velocity_;
  Supervisor supervisor_;
  Limiter limiter_;

  Own own_{};
  std::optional<PeerSample> peer_{};  // newest so far
  bool peer_is_new_ = false;
  Supervisor::Output decided_{};
  PositionError::Coupling coupling_{};
  Vector3 hold_point_ = Vector3::Zero();
  Mode last_mode_ = Mode::idle;
  bool amplifiers_on_ = false;
  bool recording_failed_ = false;
  double energy_J_ = 0.0;
  Limits limits_{};
  Fault limiter_fault_ = Fault::none;  // of the last turn
  LinkStatistics statistics_{};
  TickRecord record_{};
};

}  // namespace teleop
