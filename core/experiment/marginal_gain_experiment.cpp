#include <algorithm>
#include <memory>
#include <optional>
#include <vector>

#include "core/experiment/arm_rig.hpp"
#include "core/experiment/experiment.hpp"
#include "core/experiment/scenario.hpp"
#include "core/model/dynamics.hpp"
#include "core/model/kinematics.hpp"
#include "core/simulation/arm_sim.hpp"
#include "core/tuning/tune_point.hpp"

namespace teleop {
namespace {

/// The gain of marginal stability at home, searched as `teleop tune` does, so that it can be swept
/// over whatever a plant is made of. Both arms of a pair are simulated, on simulated time.
class MarginalGainExperiment final : public Experiment {
 public:
  void add_settings(Settings& settings) override {
    settings.add("run.experiment", &experiment_, "wall, damping or teleop");
    settings.add("run.axis", &axis_, "x, y or z");
    settings.add("run.stiffness_N_per_m", &stiffness_, "of the law, where damping is looked for",
                 kNotNegative);
    settings.add("run.damping_Ns_per_m", &damping_, "of the law, where stiffness is looked for",
                 kNotNegative);
    settings.add("run.amplitude_mm", &amplitude_mm_,
                 "of the oscillation that neither grows nor dies; 0: 10 counts, at least 0.3 mm",
                 {.low = 0.0, .high = 5.0});
    settings.add("run.width", &width_, "of the 90 % interval that is asked for, relative",
                 {.low = 0.001, .high = 0.5});
    settings.add("run.most_arm_seconds", &most_arm_seconds_, "then the search ends",
                 {.low = 1.0, .high = 3600.0});
    settings.add("run.rate_Hz", &rate_Hz_, "of the loop", {.low = 100.0, .high = 10000.0});
    teleop::add_settings(settings, "velocity.", velocity_);
  }

  void check(const Scenario& scenario) const override {
    check_integrator(scenario, scenario.plant(), "plant.", {});
    check_integrator(scenario, scenario.slave_plant(), scenario.slave_plant_key(), {});
    if (axis_ != "x" && axis_ != "y" && axis_ != "z") {
      scenario.refuse("run.axis", "the arm has no such axis; allowed: x, y, z");
    }
    if (!wanted()) scenario.refuse("run.experiment", "allowed: wall, damping, teleop");
  }

  [[nodiscard]] Results run(const Scenario& scenario, ExperimentContext& context) const override {
    SimulatedClock clock;
    std::vector<std::unique_ptr<SimulatedArm>> arms;
    ProbeRunner::Ports ports{.clock = &clock, .time_waits = true, .period_s = 1.0 / rate_Hz_};
    std::vector<ToolFrame> frames;
    const auto add = [&](const PlantSpec& plant) {
      arms.push_back(std::make_unique<SimulatedArm>(
          SimulatedArm::Config{.plant = plant, .seed = scenario.seed() + arms.size()}, clock));
      const SimulatedArm& arm = *arms.back();
      ports.arms.push_back(arms.back().get());
      frames.push_back({.J = linear_jacobian(arm.model(), JointVector::Zero()),
                        .hold_Nm = gravity_torque(arm.model(), JointVector::Zero()),
                        .counts_per_rev = arm.info().counts_per_rev});
    };
    add(scenario.plant());
    if (experiment_ == "teleop") add(scenario.slave_plant());
    PointConfig config;
    config.experiment = {.experiment = wanted().value_or(GainExperiment::wall),  // checked
                         .axis = static_cast<std::size_t>(axis_[0] - 'x'),
                         .stiffness_N_per_m = stiffness_,
                         .damping_Ns_per_m = damping_,
                         .velocity = velocity_};
    config.search.width = width_;
    config.search.most_arm_seconds = most_arm_seconds_;
    config.amplitude_m = 1e-3 * amplitude_mm_;
    config.stop_asked = [&] {
      return context.stopped();
    };
    return results_of(tune_point(config, frames, ports));
  }

 private:
  [[nodiscard]] std::optional<GainExperiment> wanted() const {
    for (const GainExperiment each :
         {GainExperiment::wall, GainExperiment::damping, GainExperiment::teleop}) {
      if (experiment_ == name_of(each)) return each;
    }
    return std::nullopt;
  }

  [[nodiscard]] Results results_of(const PointResult& point) const {
    const char* unit = experiment_ == "damping" ? "N s/m" : "N/m";
    const bool fault = std::any_of(
        point.probes.begin(), point.probes.end(),
        [](const ProbeResult& probe) { return probe.outcome.stop == ProbeStop::fault; });
    std::optional<double> gain;
    std::optional<double> low;
    std::optional<double> high;
    std::optional<double> frequency;
    if (point.crossing) {
      gain = point.crossing->gain;
      low = point.crossing->low;
      high = point.crossing->high;
      frequency = point.frequency_Hz;
    }
    return {{"gain", gain, unit},
            {"gain_low", low, unit},
            {"gain_high", high, unit},
            {"frequency_Hz", frequency, "Hz"},
            {"arm_seconds", point.arm_seconds, "s"},
            {"ended", static_cast<double>(point.end), "number: 1 found, 2 wide interval"},
            {"fault", fault ? 1.0 : 0.0, "1: an arm reported one"}};
  }

  std::string experiment_ = "wall";
  std::string axis_ = "y";
  double stiffness_ = 0.0;
  double damping_ = 0.0;
  double amplitude_mm_ = 0.0;
  double width_ = 0.01;
  double most_arm_seconds_ = 120.0;
  double rate_Hz_ = 1000.0;
  VelocityEstimator::Config velocity_{};
};

}  // namespace

extern const ExperimentKind marginal_gain_experiment;
const ExperimentKind marginal_gain_experiment{
    .name = "marginal_gain",
    .text = "the gain of marginal stability of a wall, of damping or of a pair, with its interval",
    .arms = 2,
    .make = []() -> std::unique_ptr<Experiment> {
      return std::make_unique<MarginalGainExperiment>();
    },
};

}  // namespace teleop
