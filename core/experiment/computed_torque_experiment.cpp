#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <numbers>
#include <vector>

#include <fmt/format.h>

#include "core/control/computed_torque.hpp"
#include "core/control/gravity.hpp"
#include "core/effects/hand_motion.hpp"
#include "core/experiment/arm_rig.hpp"
#include "core/experiment/experiment.hpp"
#include "core/experiment/scenario.hpp"
#include "core/model/dynamics.hpp"
#include "core/model/kinematics.hpp"

namespace teleop {
namespace {

constexpr double kFade_s = 0.5;  ///< the motion grows from rest; errors count from then on
/// So that the joints do not swing together.
constexpr std::array<double, 3> kFrequencyRatio{1.0, 0.8, 1.2};

/// All three joints swing as sines about home,
///
///     q_d,i(t) = g(t) A_i sin(2π r_i f t),   g the path of least jerk from 0 to 1.
class Swing {
 public:
  Swing(const std::array<double, 3>& amplitude_rad, double frequency_Hz)
      : amplitude_{amplitude_rad}, frequency_{frequency_Hz} {}

  [[nodiscard]] ComputedTorque::JointMotion at(double t) const noexcept {
    const double u = t / kFade_s;
    const double x = std::clamp(u, 0.0, 1.0);
    const double g = minimum_jerk(u);
    const double gd = minimum_jerk_rate(u) / kFade_s;
    const double gdd = x * (60.0 + x * (-180.0 + 120.0 * x)) / (kFade_s * kFade_s);
    ComputedTorque::JointMotion motion;
    for (std::size_t i = 0; i < kJoints; ++i) {
      const auto joint = static_cast<Eigen::Index>(i);
      const double w = 2.0 * std::numbers::pi * frequency_ * kFrequencyRatio.at(i);
      const double s = amplitude_.at(i) * std::sin(w * t);
      const double sd = amplitude_.at(i) * w * std::cos(w * t);
      motion.q[joint] = g * s;
      motion.qd[joint] = gd * s + g * sd;
      motion.qdd[joint] = gdd * s + 2.0 * gd * sd - g * w * w * s;
    }
    return motion;
  }

 private:
  std::array<double, 3> amplitude_;
  double frequency_;
};

/// How one controller followed.
struct Tracking {
  double sum = 0.0;
  double peak_m = 0.0;
  double turns = 0.0;
  std::uint64_t cut_turns = 0;
  std::vector<std::pair<double, double>> error;  ///< s, mm

  [[nodiscard]] std::optional<double> rms_m() const {
    if (turns == 0.0) return std::nullopt;
    return std::sqrt(sum / turns);
  }
};

/// One fast motion of all joints, followed twice with the same gains: by computed torque, and by
///
///     τ = M(0) (K_d ė + K_p e) + share · N(q),
///
/// plain PD at the inertia of home with the arm's weight carried, so that the difference is what
/// the rest of the model brings.
class ComputedTorqueExperiment final : public Experiment {
 public:
  void add_settings(Settings& settings) override {
    settings.add("run.seconds", &seconds_, "each controller", {.low = 1.0, .high = 600.0});
    settings.add("run.frequency_Hz", &frequency_Hz_, "of joint 1; joints 2 and 3 at 0.8 and 1.2",
                 {.low = 0.05, .high = 20.0});
    settings.add("run.amplitude_rad", &amplitude_rad_, "of each joint about home", kNotNegative);
    teleop::add_settings(settings, "computed_torque.", law_);
    teleop::add_settings(settings, "gravity.", gravity_);
    teleop::add_settings(settings, rig_);
  }

  void check(const Scenario& scenario) const override {
    check_integrator(scenario, scenario.plant(), "plant.", {});
    const ArmModel model = load_arm(scenario.plant().arm);
    const Swing swing{amplitude_rad_, frequency_Hz_};
    for (int i = 0; i <= 2000; ++i) {
      const double t = seconds_ * i / 2000.0;
      const ComputedTorque::JointMotion motion = swing.at(t);
      const Reach reach = check_limits(model, motion.q);
      if (reach != Reach::ok) {
        scenario.refuse("run.amplitude_rad",
                        "the motion leaves the workspace: " + std::string{text_of(reach)});
      }
      if (motion.qd.cwiseAbs().maxCoeff() > rig_.max_joint_speed_rad_per_s) {
        scenario.refuse("run.frequency_Hz",
                        "the motion is faster than limits.max_joint_speed_rad_per_s");
      }
    }
  }

  [[nodiscard]] Results run(const Scenario& scenario, ExperimentContext& context) const override {
    ArmRig rig{rig_, scenario, context};
    const ArmModel& model = rig.model();
    const ComputedTorque law{law_, model};
    const GravityCompensation weight{gravity_, model};
    const JointMatrix M = mass_matrix(model, JointVector::Zero());
    const JointVector Kp{law_.stiffness_per_s2.data()};
    const JointVector Kd{law_.damping_per_s.data()};
    const Tracking computed = follow(rig, [&](const ArmTurn& turn, const auto& desired) noexcept {
      return law.step(turn.q, turn.qd, desired);
    });
    const Tracking plain = follow(rig, [&](const ArmTurn& turn, const auto& desired) noexcept {
      const JointVector wanted =
          Kp.cwiseProduct(desired.q - turn.q) + Kd.cwiseProduct(desired.qd - turn.qd);
      return JointVector{M * wanted + weight.step(turn.q)};
    });
    (void)rig.move_to(JointVector::Zero(), 0.5, 0.2);
    if (context.figures != nullptr) {
      context.figures->push_back(
          {.name = "tracking",
           .title = "Tracking error of the tool on the same fast motion",
           .x_label = "time (s)",
           .y_label = "error (mm)",
           .curves = {{.label = "plain PD", .points = plain.error},
                      {.label = "computed torque", .points = computed.error}}});
    }
    return results_of(computed, plain, rig.fault());
  }

 private:
  template <class Law>
  [[nodiscard]] Tracking follow(ArmRig& rig, Law&& law) const {
    Tracking tracking;
    tracking.error.reserve(static_cast<std::size_t>(seconds_ * rig_.rate_Hz) + 2);
    if (rig.move_to(JointVector::Zero(), 0.5, 0.3) != ArmRig::Ending::time_over) return tracking;
    const Swing swing{amplitude_rad_, frequency_Hz_};
    const ArmModel& model = rig.model();
    const std::uint64_t cut_before = rig.cut_turns();
    (void)rig.run(seconds_, [&](const ArmTurn& turn) noexcept -> std::optional<JointVector> {
      const ComputedTorque::JointMotion desired = swing.at(turn.t_s);
      const double error = (tool_position(model, desired.q) - tool_position(model, turn.q)).norm();
      const bool room = tracking.error.size() < tracking.error.capacity();
      if (room) tracking.error.emplace_back(turn.t_s, 1e3 * error);
      if (turn.t_s > kFade_s) {
        tracking.sum += error * error;
        tracking.peak_m = std::max(tracking.peak_m, error);
        tracking.turns += 1.0;
      }
      return law(turn, desired);
    });
    tracking.cut_turns = rig.cut_turns() - cut_before;
    return tracking;
  }

  [[nodiscard]] static Results results_of(const Tracking& computed,
                                          const Tracking& plain,
                                          Fault fault) {
    const auto rms_mm = [](const Tracking& tracking) {
      const auto rms = tracking.rms_m();
      return rms ? std::optional{1e3 * *rms} : std::nullopt;
    };
    const auto share = [](const Tracking& tracking) {
      return static_cast<double>(tracking.cut_turns) / std::max(tracking.turns, 1.0);
    };
    const std::optional<double> with = computed.rms_m();
    const std::optional<double> without = plain.rms_m();
    const std::optional<double> ratio =
        with && without ? std::optional{*without / *with} : std::nullopt;
    return {
        {"error_rms_mm", rms_mm(computed), "mm"}, {"error_peak_mm", 1e3 * computed.peak_m, "mm"},
        {"error_pd_rms_mm", rms_mm(plain), "mm"}, {"error_pd_peak_mm", 1e3 * plain.peak_m, "mm"},
        {"pd_over_computed_torque", ratio, "1"},  {"cut_share", share(computed), "1"},
        {"cut_pd_share", share(plain), "1"},      {"fault", static_cast<double>(fault), "number"}};
  }

  double seconds_ = 4.0;
  double frequency_Hz_ = 2.0;
  std::array<double, 3> amplitude_rad_{0.4, 0.3, 0.3};
  ComputedTorque::Config law_{};
  GravityCompensation::Config gravity_{};
  ArmRig::Config rig_{.max_joint_speed_rad_per_s = 30.0};
};

}  // namespace

extern const ExperimentKind computed_torque_experiment;
const ExperimentKind computed_torque_experiment{
    .name = "computed_torque",
    .text = "tracking error of computed torque and of plain PD with the same gains, a fast motion",
    .hardware = true,
    .make = []() -> std::unique_ptr<Experiment> {
      return std::make_unique<ComputedTorqueExperiment>();
    },
};

}  // namespace teleop
