#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "core/base/fault.hpp"
#include "core/estimation/difference_velocity.hpp"
#include "core/identification/frequency_response.hpp"
#include "core/model/arm_model.hpp"
#include "core/ports/arm.hpp"
#include "core/realtime/loop.hpp"

namespace teleop {

/// Why a drive ended.
enum class DriveEnd : std::uint8_t {
  running,       ///< it has not
  done,          ///< all periods are there
  travel,        ///< the tool left its bounds
  speed,         ///< the tool went too fast
  torque_cut,    ///< the device cut the torque: what acted is not known
  device_fault,  ///< the device reported a fault or something that is not a number
  interrupted,   ///< somebody wanted it to stop
};
[[nodiscard]] std::string_view text_of(DriveEnd end) noexcept;

/// Plays periodic forces along one tool axis of an arm and keeps what it did, from rest to rest:
///
///     F = −K p − B v + F_0 + r(t) e_axis,   p = J(q_0)(q − q_0),   τ = J(q_0)ᵀ F + share · N(q)
///
/// K and B are a weak loop that keeps the driven axis near its place and the other two out of the
/// way. F_0 carries the weight: while the arm is centred, with a stiffer loop, an integral finds
/// it; then it stays as it is. Weight that changes with the posture acts like a spring, for a
/// PHANToM along z a negative one of 2.6 N/m; the share of N(q) takes it out of the response. F is
/// shortened to the largest force, which the record shows. A segment is one reference, played a few
/// periods until the motion repeats itself, then for the periods that are kept.
///
/// Beyond its bounds the drive drops the reference and brakes with the weak loop; a device fault
/// ends it with zero torque at once. At the end the force fades, torque is zero, amplifiers are
/// off. Samples that a late loop missed are marked and their periods are left out.
///
/// Thread: the loop's. Loop: step neither allocates, blocks nor throws.
class PeriodicDrive {
 public:
  struct Config {
    std::size_t axis = 0;  ///< 0 to 2: x, y, z
    double rate_Hz = 10000.0;
    double stiffness_N_per_m = 20.0;  ///< K
    double damping_Ns_per_m = 1.0;    ///< B
    double centring_stiffness_N_per_m = 100.0;
    double centring_damping_Ns_per_m = 3.0;
    double integral_per_s = 4.0;  ///< of the stiffness, while centring
    double cutoff_Hz = 100.0;     ///< of the velocity in the weak loop
    double centring_s = 1.5;
    std::optional<JointVector> q_0{};  ///< where to centre; absent: where it stands
    double gravity_share = 0.0;        ///< of the model's N(q) that is carried besides
    double max_force_N = 5.0;
    double max_travel_m = 0.005;  ///< from where it began, every axis
    double max_speed_m_per_s = 1.0;
  };

  struct Segment {
    Eigen::VectorXd reference_N;  ///< one period
    std::size_t settle_periods = 1;
    std::size_t periods = 2;
  };

  struct Outcome {
    DriveEnd end = DriveEnd::running;
    Fault fault = Fault::none;
    bool at_rest = false;           ///< the tool stood still before the torque went to zero
    double largest_force_N = 0.0;   ///< commanded
    double largest_travel_m = 0.0;  ///< of any axis
    double largest_speed_m_per_s = 0.0;
    std::uint64_t shortened = 0;  ///< samples whose force was cut to the largest
    std::uint64_t missed = 0;     ///< samples that never happened
  };

  /// The model gives the Jacobian at home; the flag ends the drive from another thread.
  PeriodicDrive(const Config& config,
                const ArmModel& model,
                std::vector<Segment> segments,
                const std::atomic<bool>& stop);

  [[nodiscard]] Next step(Arm& arm, const Tick& tick) noexcept;

  [[nodiscard]] const Outcome& outcome() const noexcept { return outcome_; }
  [[nodiscard]] const JointVector& centre() const noexcept { return q_0_; }
  /// What a drive takes besides its segments, s.
  [[nodiscard]] static double overhead_s(const Config& config) noexcept;

  /// Of each segment, the periods without a missed sample.
  [[nodiscard]] std::vector<PeriodicRecord> records() const;

 private:
  enum class Phase : std::uint8_t { centring, playing, settling, watching, fading };

  struct Kept {
    PeriodicRecord record;
    std::vector<std::uint8_t> whole;  ///< of each period: no sample missed
  };

  void begin(const ArmState& state) noexcept;
  void observe(const ArmState& state, const Tick& tick) noexcept;
  void check(const ArmState& state) noexcept;
  void brake(DriveEnd why) noexcept;
  [[nodiscard]] bool must_end() const noexcept;
  [[nodiscard]] double play() noexcept;
  [[nodiscard]] double sample(std::size_t segment) const noexcept;
  void skip() noexcept;
  void keep(double force_N) noexcept;
  [[nodiscard]] Vector3 hold(double dt) noexcept;
  void enter(Phase phase) noexcept;
  void advance_phase() noexcept;
  [[nodiscard]] std::uint64_t samples_of(double duration_s) const noexcept;

  Config config_;
  const ArmModel& model_;
  std::vector<Segment> segments_;
  const std::atomic<bool>& stop_;
  std::vector<Kept> kept_;
  DifferenceVelocity velocity_;
  Outcome outcome_{};

  Phase phase_ = Phase::centring;
  std::uint64_t in_phase_ = 0;  ///< samples since the phase began
  std::uint64_t last_sample_ = 0;
  std::size_t segment_ = 0;
  std::uint64_t in_segment_ = 0;
  std::uint64_t just_missed_ = 0;
  bool begun_ = false;
  JointVector q_0_ = JointVector::Zero();
  double start_m_ = 0.0;  ///< how far from its place it began
  Matrix3 J_ = Matrix3::Identity();
  Vector3 p_ = Vector3::Zero();
  Vector3 v_ = Vector3::Zero();
  Vector3 weight_ = Vector3::Zero();  ///< F_0
  Vector3 lowest_ = Vector3::Zero();  ///< while watching for rest
  Vector3 highest_ = Vector3::Zero();
};

}  // namespace teleop
