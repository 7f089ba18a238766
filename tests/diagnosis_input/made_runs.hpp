#pragma once

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <numbers>
#include <string>

#include <fmt/format.h>

#include "core/diagnosis/audit.hpp"
#include "core/diagnosis/recording.hpp"
#include "core/math/random.hpp"
#include "core/model/dynamics.hpp"
#include "core/realtime/clock.hpp"
#include "core/simulation/arm_sim.hpp"
#include "tests/support/temporary_folder.hpp"

namespace teleop::testing {

/// A property test's number of cases.
inline int cases(int usual) {
  const char* text = std::getenv("TELEOP_CASES");  // NOLINT(concurrency-mt-unsafe)
  return text != nullptr ? std::atoi(text) : usual;
}

/// Runs of a simulated PHANToM whose joints follow sums of sines under PD control with gravity
/// compensation, as an experimenter would record them.
struct Motion {
  double seconds = 4.0;
  double fastest_Hz = 4.0;
  double amplitude_rad = 0.15;
};

inline Recording made_run(const PlantSpec& plant, std::uint64_t seed, const Motion& motion = {}) {
  constexpr double kPeriod = 1e-3;
  Random random{seed};
  SimulatedClock clock;
  const JointVector home{0.0, 0.4, 0.25};
  SimulatedArm arm{{.plant = plant, .seed = seed, .q = home}, clock};
  std::array<JointVector, 4> frequency{};
  std::array<JointVector, 4> phase{};
  for (std::size_t n = 0; n < frequency.size(); ++n) {
    for (Eigen::Index i = 0; i < 3; ++i) {
      frequency.at(n)[i] = random.uniform(0.2, motion.fastest_Hz);
      phase.at(n)[i] = random.uniform(0.0, 2.0 * std::numbers::pi);
    }
  }
  const JointVector stiffness{4.0, 3.0, 1.5};
  const JointVector damping{0.12, 0.09, 0.04};
  Recording run{.name = fmt::format("run-{:02}.csv", seed)};
  run.first_row = 2;
  JointVector before = home;
  JointVector speed = JointVector::Zero();
  arm.amplifiers(true);
  for (int k = 0; k < static_cast<int>(motion.seconds / kPeriod); ++k) {
    const double t = kPeriod * k;
    JointVector wanted = home;
    const double ramp = std::min(1.0, t / 0.5);
    for (std::size_t n = 0; n < frequency.size(); ++n) {
      wanted += ramp * motion.amplitude_rad / 2.0 *
                (2.0 * std::numbers::pi * frequency.at(n) * t + phase.at(n)).array().sin().matrix();
    }
    const JointVector q = arm.read().q;
    speed += 0.2 * ((q - before) / kPeriod - speed);
    before = q;
    JointVector tau = stiffness.cwiseProduct(wanted - q) - damping.cwiseProduct(speed) +
                      gravity_torque(arm.model(), q);
    tau = (tau / 1e-5).array().round() * 1e-5;
    arm.write(tau);
    run.t_s.push_back(t);
    run.q.push_back(q);
    run.tau.push_back(tau);
    clock.sleep_until(clock.now() + std::chrono::milliseconds{1});
  }
  return run;
}

inline DiagnosisCase made_case(const PlantSpec& plant,
                               std::uint64_t seed,
                               const Motion& motion = {}) {
  const double turn = 2.0 * std::numbers::pi;
  return {.name = "made",
          .period_s = 1e-3,
          .command_step = 1e-5,
          .resolution = {turn / 54476.8, turn / 45875.2, turn / 45875.2},
          .runs = {made_run(plant, seed, motion), made_run(plant, seed + 1, motion)}};
}

/// The plant without anything left out.
inline PlantSpec ideal_plant() { return load_plant("phantom-1.5-bare"); }

/// A case of one run, run-01.csv.
inline constexpr const char* kArmCase = R"(
case = "bench-7"
plant = "phantom-1.5"
sample_rate_Hz = 1000
torque_convention = "zero-order hold"
encoder_counts_per_joint_revolution = [54476.8, 45875.2, 45875.2]
torque_command_step_Nm = 0.00001
[[run]]
file = "run-01.csv"
excitation = "by hand"
)";

/// A run as the CSV file of a case folder.
inline std::string csv_of(const Recording& run) {
  std::string text = "t_s,tau1_Nm,tau2_Nm,tau3_Nm,q1_rad,q2_rad,q3_rad\n";
  for (std::size_t k = 0; k < run.rows(); ++k) {
    const JointVector& tau = run.tau[k];
    const JointVector& q = run.q[k];
    text += fmt::format("{:.3f},{:.5f},{:.5f},{:.5f},{:.7f},{:.7f},{:.7f}\n", run.t_s[k], tau[0],
                        tau[1], tau[2], q[0], q[1], q[2]);
  }
  return text;
}

inline std::filesystem::path shared(const std::string& name) {
  return std::filesystem::path{TELEOP_SOURCE_DIR} / ".." / "shared" / name;
}

/// Findings worse than notes, a line each.
inline std::string complaints(const Audit& found) {
  std::string lines;
  for (const Finding& finding : found.findings) {
    if (finding.severity == Severity::note) continue;
    lines += std::string{name_of(finding.severity)} + " " + finding.kind + ": " + line_of(finding) +
             '\n';
  }
  return lines;
}

}  // namespace teleop::testing
