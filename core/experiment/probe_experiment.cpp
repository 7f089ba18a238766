#include <array>
#include <cmath>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "core/base/error.hpp"
#include "core/experiment/arm_rig.hpp"
#include "core/experiment/experiment.hpp"
#include "core/experiment/scenario.hpp"
#include "core/identification/probe_motion.hpp"
#include "core/recording/log_writer.hpp"

namespace teleop {
namespace {

/// An arm plays a probe motion under weak springs at its joints, the weight carried, and every turn
/// goes into a log that `teleop diagnose` reads; on simulated time, or on a real arm through the
/// port.
class ProbeExperiment final : public Experiment {
 public:
  void add_settings(Settings& settings) override {
    settings.add("run.motion", &motion_,
                 "slow_sweep, fast_sweep, multisine, triangles, rest_repeat, postures, hands_off");
    settings.add("run.seconds", &seconds_, "0: as long as the motion takes",
                 {.low = 0.0, .high = 600.0});
    settings.add("run.log", &log_, "file for the recording; empty: none");
    settings.add("run.role", &role_,
                 "of the arm in the recordings that it goes with: master or slave");
    settings.add("law.home_rad", &law_.home_rad, "posture about which it moves");
    settings.add("law.stiffness_Nm_per_rad", &law_.stiffness_Nm_per_rad, "of the joints' springs");
    settings.add("law.damping_Nms_per_rad", &law_.damping_Nms_per_rad, "of the joints' dampers");
    settings.add("law.stiff_factor", &law_.stiff_factor,
                 "of the stiffness in motions of few counts", {.low = 1.0, .high = 10.0});
    teleop::add_settings(settings, rig_);
  }

  void check(const Scenario& scenario) const override {
    if (scenario.simulated()) check_integrator(scenario, scenario.plant(), "plant.", {});
    try {
      static_cast<void>(find_probe_motion(motion_));
    } catch (const ConfigError& error) {
      scenario.refuse("run.motion", error.what());
    }
    if (role_ != "master" && role_ != "slave") {
      scenario.refuse("run.role", "allowed: master, slave");
    }
    if (!log_.empty() && std::filesystem::exists(log_)) {
      scenario.refuse("run.log", "exists already; give another name, --set run.log=...");
    }
    for (const auto* gains : {&law_.stiffness_Nm_per_rad, &law_.damping_Nms_per_rad}) {
      for (const double each : *gains) {
        if (each >= 0.0 && std::isfinite(each)) continue;
        scenario.refuse(gains == &law_.damping_Nms_per_rad ? "law.damping_Nms_per_rad"
                                                           : "law.stiffness_Nm_per_rad",
                        "must not be negative");
      }
    }
  }

  [[nodiscard]] Results run(const Scenario& scenario, ExperimentContext& context) const override {
    const ProbeMotion& motion = find_probe_motion(motion_);
    const double length_s = seconds_ > 0.0 ? seconds_ : motion.seconds;
    std::vector<TickRecord> tape;
    tape.reserve(static_cast<std::size_t>(length_s * rig_.rate_Hz) + 2);
    ArmRig rig{rig_, scenario, context};
    const ProbeLaw law{law_, rig.model(), motion};
    constexpr double kMove_s = 1.0;
    constexpr double kSettle_s = 0.5;
    rig.move_to(law.start(), kMove_s, kSettle_s);
    double squares = 0.0;
    JointVector farthest = JointVector::Zero();
    rig.record_to(&tape);
    rig.run(length_s, [&](const ArmTurn& turn) noexcept -> std::optional<JointVector> {
      squares += turn.qd.squaredNorm();
      farthest = farthest.cwiseMax((turn.q - law.start()).cwiseAbs());
      return law.step(turn.t_s, turn.q, turn.qd);
    });
    rig.record_to(nullptr);
    if (!log_.empty()) write(scenario, rig, tape);
    const auto turns = static_cast<double>(std::max<std::size_t>(tape.size(), 1));
    return {{"seconds", static_cast<double>(tape.size()) / rig_.rate_Hz, "s, recorded"},
            {"records", static_cast<double>(tape.size()), "turns"},
            {"travel_rad", farthest.maxCoeff(), "rad, farthest of any joint from the start"},
            {"speed_rms_rad_per_s", std::sqrt(squares / turns), "rad/s, of all joints together"},
            {"cut_turns", static_cast<double>(rig.cut_turns()), "turns shortened by a limit"},
            {"fault", static_cast<double>(rig.fault()), "number"}};
  }

 private:
  void write(const Scenario& scenario,
             const ArmRig& rig,
             const std::vector<TickRecord>& tape) const {
    LogWriter writer{{.file = log_,
                      .role = role_ == "master" ? Role::master : Role::slave,
                      .metadata = {{"arm", rig.model().parameters().name},
                                   {"rate_Hz", fmt::format("{}", rig_.rate_Hz)},
                                   {"experiment", "probe " + motion_},
                                   {"seed", fmt::format("{}", scenario.seed())},
                                   {"config", scenario.settings().print()}}}};
    for (const TickRecord& record : tape) {
      writer.append(record);
    }
    writer.close();
  }

  std::string motion_ = "slow_sweep";
  double seconds_ = 0.0;
  std::string log_{};
  std::string role_ = "slave";
  ProbeLaw::Config law_{};
  ArmRig::Config rig_{.velocity = {.kind = "difference"}};
};

}  // namespace

extern const ExperimentKind probe_experiment;
const ExperimentKind probe_experiment{
    .name = "probe",
    .text = "an arm plays a motion that makes its physics show, and records it for diagnosis",
    .hardware = true,
    .make = []() -> std::unique_ptr<Experiment> { return std::make_unique<ProbeExperiment>(); },
};

}  // namespace teleop
