#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <vector>

#include "core/math/random.hpp"
#include "scenarios/bench_tune.hpp"

namespace teleop {
namespace {

LinearAxis::Config random_axis(Random& random, double period_s) {
  LinearAxis::Config axis;
  const double mass = random.uniform(0.020, 0.120);
  axis.mass_kg = mass;
  axis.damping_Ns_per_m = random.uniform(0.2, 5.0);
  axis.delay_s = random.uniform(0.0, 2.9) * period_s;
  axis.lag_s = random.uniform(0.0, 1e-3);
  const bool has_mode = random.uniform() < 0.5;
  const double share = random.uniform(0.3, 0.8);  // of the mass, before the joint
  const double frequency_Hz = 40.0 * std::pow(250.0 / 40.0, random.uniform());
  const double zeta = random.uniform(0.03, 0.2);
  if (has_mode) {
    // The mode of both masses against each other, with the ground left out.
    axis.mass_kg = share * mass;
    axis.second_mass_kg = (1.0 - share) * mass;
    const double reduced = axis.mass_kg * axis.second_mass_kg / mass;
    const double omega = 2.0 * std::numbers::pi * frequency_Hz;
    axis.joint_N_per_m = reduced * omega * omega;
    axis.joint_damping_Ns_per_m = 2.0 * zeta * reduced * omega;
  }
  return axis;
}

/// An arm that is watched: the plant's true motion at every call of the port.
class WatchedArm final : public Arm {
 public:
  WatchedArm(const LinearArm::Config& config, std::size_t axis, Clock& clock, TunedCase& seen)
      : arm_{config, clock}, axis_{static_cast<Eigen::Index>(axis)}, seen_{&seen} {}

  [[nodiscard]] const ArmInfo& info() const noexcept override { return arm_.info(); }
  [[nodiscard]] ArmState read() noexcept override {
    const ArmState state = arm_.read();
    watch();
    return state;
  }
  void write(const JointVector& tau) noexcept override {
    arm_.write(tau);
    watch();
  }
  void amplifiers(bool on) noexcept override { arm_.amplifiers(on); }

  void begin_probe() noexcept { work_J_ = 0.0; }

 private:
  void watch() noexcept {
    const LinearArm::Truth truth = arm_.true_state();
    const double x = truth.position[axis_];
    work_J_ += force_N_ * (x - x_);
    x_ = x;
    force_N_ = truth.force[axis_];
    const auto keep = [](double& most, double value) {
      most = std::max(most, std::abs(value));
    };
    keep(seen_->true_travel_m, x);
    keep(seen_->true_speed_m_per_s, truth.velocity[axis_]);
    keep(seen_->true_force_N, force_N_);
    seen_->true_energy_J = std::max({seen_->true_energy_J, work_J_, truth.kinetic_energy_J});
  }

  LinearArm arm_;
  Eigen::Index axis_;
  TunedCase* seen_;
  double x_ = 0.0;
  double force_N_ = 0.0;
  double work_J_ = 0.0;
};

}  // namespace

TuneCase random_case(std::uint64_t seed, std::size_t index) {
  Random random{seed * 1'000'003 + index};
  TuneCase one;
  one.experiment = static_cast<GainExperiment>(index % 3);
  one.axis = static_cast<std::size_t>(random.uniform(0.0, 3.0));
  one.loop.arms.push_back(random_axis(random, one.loop.period_s));
  if (one.experiment == GainExperiment::teleop) {
    one.loop.arms.push_back(random_axis(random, one.loop.period_s));
  }
  const int samples = static_cast<int>(std::lround(8.0 * std::pow(100.0 / 8.0, random.uniform())));
  if (one.experiment == GainExperiment::damping) {
    one.loop.velocity = {.kind = "mean", .mean = {.samples = samples}};
  }
  one.quantum_m = random.uniform(10e-6, 60e-6);
  const bool damps = one.experiment == GainExperiment::damping;
  one.margin = nyquist_margin(one.loop, damps ? TunedGain::damping : TunedGain::stiffness);
  return one;
}

TunedCase tune_case(const TuneCase& one) {
  TunedCase result;
  SimulatedClock clock;
  std::vector<std::unique_ptr<WatchedArm>> arms;
  ProbeRunner::Ports ports{.clock = &clock, .time_waits = true, .period_s = one.loop.period_s};
  std::vector<ToolFrame> frames;
  for (const LinearAxis::Config& axis : one.loop.arms) {
    LinearArm::Config config{.quantum_m = one.quantum_m};
    config.axes[one.axis] = axis;
    arms.push_back(std::make_unique<WatchedArm>(config, one.axis, clock, result));
    ports.arms.push_back(arms.back().get());
    frames.push_back({.J = LinearArm::lever_m().asDiagonal(),
                      .counts_per_rev = arms.back()->info().counts_per_rev});
  }
  PointConfig config;
  config.experiment = {.experiment = one.experiment,
                       .axis = one.axis,
                       .velocity = one.loop.velocity,
                       .hold_stiffness_N_per_m = 10.0,
                       .hold_damping_Ns_per_m = 0.5};
  config.on_probe = [&](const ProbeResult&) {
    for (const auto& arm : arms) {
      arm->begin_probe();
    }
  };
  result.point = tune_point(config, frames, ports);
  const ProbeBounds& bounds = config.bounds;
  result.within_bounds = result.true_speed_m_per_s <= bounds.speed_m_per_s &&
                         result.true_travel_m <= bounds.travel_m &&
                         result.true_force_N <= bounds.force_N + 1e-9 &&
                         result.true_energy_J <= bounds.energy_J;
  return result;
}

}  // namespace teleop
