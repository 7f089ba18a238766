#include "core/tuning/loop_under_test.hpp"

#include <algorithm>
#include <cmath>

#include "core/base/contract.hpp"
#include "core/base/error.hpp"

namespace teleop {
namespace {

constexpr double kHoldCutoff_Hz = 20.0;

}  // namespace

LoopUnderTest::LoopUnderTest(const ExperimentConfig& config, const std::vector<ToolFrame>& frames)
    : config_{config}, axis_{static_cast<Eigen::Index>(config.axis)} {
  const bool pair = config.experiment == GainExperiment::teleop;
  expects(frames.size() == (pair ? 2U : 1U), "loop under test: one frame an arm");
  expects(config.axis < 3, "loop under test: axis x, y or z");
  const auto most = static_cast<int>(kMostDelay);
  if (config.peer_delay_samples < 0 || config.peer_delay_samples > most) {
    throw ConfigError{"tuning: the peer's delay must be 0 to 16 samples"};
  }
  for (const ToolFrame& frame : frames) {
    sides_.push_back({.frame = frame,
                      .law_velocity = VelocityEstimator{config.velocity, frame.counts_per_rev},
                      .hold_velocity = DifferenceVelocity{{.cutoff_Hz = kHoldCutoff_Hz}}});
  }
}

void LoopUnderTest::reset() noexcept {
  for (Side& side : sides_) {
    side.law_velocity.reset();
    side.hold_velocity.reset();
    side.motion.fill({});
  }
}

void LoopUnderTest::set_hold(double stiffness_N_per_m, double damping_Ns_per_m) noexcept {
  config_.hold_stiffness_N_per_m = stiffness_N_per_m;
  config_.hold_damping_Ns_per_m = damping_Ns_per_m;
}

void LoopUnderTest::sense(Side& side, const ArmState& arm, double dt) noexcept {
  const VelocitySample sample{.q = arm.q, .period_ticks = arm.period_ticks, .dt = dt};
  const JointVector qd = side.law_velocity.step(sample);
  side.rate = side.frame.J * side.hold_velocity.step(sample);
  std::copy_backward(side.motion.begin(), side.motion.end() - 1, side.motion.end());
  side.motion[0] = {.x = side.frame.displacement(arm.q)[axis_], .v = (side.frame.J * qd)[axis_]};
}

double LoopUnderTest::law(std::size_t arm, double gain) const noexcept {
  const bool damps = config_.experiment == GainExperiment::damping;
  const double G = damps ? config_.stiffness_N_per_m : gain;
  const double B = damps ? gain : config_.damping_Ns_per_m;
  const Motion& own = sides_[arm].motion[0];
  double force = -G * own.x - B * own.v;
  if (sides_.size() == 2) {
    const auto age = static_cast<std::size_t>(config_.peer_delay_samples);
    const Motion& peer = sides_[1 - arm].motion[age];
    force += G * peer.x + B * peer.v;
  }
  return force;
}

LoopUnderTest::Turn LoopUnderTest::step(const std::array<ArmState, kMostArms>& arms,
                                        const Command& command,
                                        double dt) noexcept {
  Turn turn;
  for (std::size_t i = 0; i < sides_.size(); ++i) {
    sense(sides_[i], arms[i], dt);
  }
  for (std::size_t i = 0; i < sides_.size(); ++i) {
    const Side& side = sides_[i];
    const Vector3 d = side.frame.displacement(arms[i].q);
    Vector3 f = -config_.hold_stiffness_N_per_m * d - config_.hold_damping_Ns_per_m * side.rate;
    const double wanted = (command.hold_axis ? f[axis_] : 0.0) + law(i, command.gain) +
                          (i == 0 ? command.push_N : -command.push_N);
    f[axis_] = std::clamp(wanted, -command.most_force_N, command.most_force_N);
    turn.cut = turn.cut || f[axis_] != wanted;
    turn.displacement[i] = d;
    turn.force_N[i] = f[axis_];
    turn.torque_Nm[i] = side.frame.J.transpose() * f + side.frame.hold_Nm;
  }
  return turn;
}

}  // namespace teleop
