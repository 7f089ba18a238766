#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <utility>

#include "core/experiment/experiment.hpp"
#include "core/experiment/scenario.hpp"
#include "core/simulation/held_motor.hpp"

namespace teleop {
namespace {

/// A motor holds a force at the tool for minutes, as in [Cavusoglu 2002, section 4.1]: along y at
/// home, which joint 2 carries alone. Lever and transmission are those of the plant's arm; the
/// motor is what the keys motor.* say, by default the assumed one of docs/paper.md, and the
/// plant's effects have no part in it. Simulated time; the arm does not move.
class MotorHeatExperiment final : public Experiment {
 public:
  void add_settings(Settings& settings) override {
    settings.add("run.force_N", &force_N_, "at the tool, held", {.low = 0.0, .high = 20.0});
    settings.add("run.seconds", &seconds_, "how long", {.low = 1.0, .high = 86'400.0});
    settings.add("run.drive", &drive_, "linear (a current) or pwm (a duty: the stock drive)");
    settings.add("motor.full_force_N", &full_force_N_,
                 "at the tool, of full duty with a cold winding (pwm)", kPositive);
    settings.add("motor.torque_constant_Nm_per_A", &torque_constant_, "of the motor", kPositive);
    settings.add("motor.resistance_ohm", &motor_.resistance_ohm, "of the winding, cold", kPositive);
    settings.add("motor.inductance_H", &motor_.inductance_H, "of the winding", kPositive);
    settings.add("motor.carrier_Hz", &motor_.carrier_Hz, "of the switching (pwm)",
                 {.low = 100.0, .high = 1e5});
    settings.add("motor.winding_to_housing_K_per_W", &motor_.winding_to_housing_K_per_W, "R_wh",
                 kPositive);
    settings.add("motor.housing_to_ambient_K_per_W", &motor_.housing_to_ambient_K_per_W, "R_ha",
                 kPositive);
    settings.add("motor.winding_J_per_K", &motor_.winding_J_per_K, "C_w", kPositive);
    settings.add("motor.housing_J_per_K", &motor_.housing_J_per_K, "C_h", kPositive);
    settings.add("motor.copper_per_K", &motor_.copper_per_K, "rise of the resistance",
                 kNotNegative);
    settings.add("motor.magnet_per_K", &motor_.magnet_per_K,
                 "fall of the torque constant with the housing", kNotNegative);
    settings.add("motor.ambient_C", &motor_.ambient_C, "of the room, where it starts");
  }

  void check(const Scenario& scenario) const override {
    if (drive_ != "linear" && drive_ != "pwm") {
      scenario.refuse("run.drive", "no such drive; allowed: linear, pwm");
    }
    if (drive_ == "pwm" && force_N_ > full_force_N_) {
      scenario.refuse("run.force_N", "more than motor.full_force_N, which is full duty");
    }
  }

  [[nodiscard]] Results run(const Scenario& scenario, ExperimentContext& context) const override {
    HeldMotor motor{config_of(scenario)};
    motor.hold(std::min(kFirst_s, seconds_));
    const double torque_first = motor.torque_Nm();
    double time_s = std::min(kFirst_s, seconds_);
    Figure::Curve casing{.label = "casing",
                         .points = {{0.0, 0.0}, {time_s, motor.casing_rise_K()}}};
    Figure::Curve winding{.label = "winding",
                          .points = {{0.0, 0.0}, {time_s, motor.winding_rise_K()}}};
    double warmest_K = motor.winding_rise_K();
    const double part_s = std::max(1.0, seconds_ / 500.0);
    while (time_s < seconds_ && !context.stopped()) {
      const double next_s = std::min(part_s, seconds_ - time_s);
      motor.hold(next_s);
      time_s += next_s;
      warmest_K = std::max(warmest_K, motor.winding_rise_K());
      casing.points.emplace_back(time_s, motor.casing_rise_K());
      winding.points.emplace_back(time_s, motor.winding_rise_K());
    }
    if (context.figures != nullptr) {
      context.figures->push_back({.name = "motor-heat",
                                  .title = "A motor that holds a force",
                                  .x_label = "time (s)",
                                  .y_label = "above ambient (K)",
                                  .curves = {std::move(winding), std::move(casing)}});
    }
    std::optional<double> loss;
    if (torque_first > 0.0) loss = 1.0 - motor.torque_Nm() / torque_first;
    return {{"casing_rise_K", motor.casing_rise_K(), "K"},
            {"winding_rise_K", motor.winding_rise_K(), "K"},
            {"winding_peak_K", warmest_K, "K, largest rise on the way"},
            {"torque_loss", loss, "share of the torque after the first second"},
            {"current_A", motor.current_A(), "A, mean, at the end"},
            {"seconds", time_s, "s"},
            {"fault", 0.0, "number"}};
  }

 private:
  static constexpr double kFirst_s = 1.0;

  [[nodiscard]] HeldMotor::Config config_of(const Scenario& scenario) const {
    const ArmModel arm = load_arm(scenario.plant().arm);
    const double lever_m = arm.parameters().l1_m;
    HeldMotor::Config config = motor_;
    config.pwm = drive_ == "pwm";
    config.torque_Nm = force_N_ * lever_m;
    config.full_torque_Nm = full_force_N_ * lever_m;
    config.torque_per_ampere = torque_constant_ * arm.parameters().transmission_ratio[1];
    return config;
  }

  double force_N_ = 2.0;
  double seconds_ = 600.0;
  std::string drive_ = "linear";
  double full_force_N_ = 8.5;
  double torque_constant_ = 0.0234;
  HeldMotor::Config motor_{};
};

}  // namespace

extern const ExperimentKind motor_heat_experiment;
const ExperimentKind motor_heat_experiment{
    .name = "motor_heat",
    .text = "a motor holds a force for minutes: how warm, and how much torque is lost?",
    .make = []() -> std::unique_ptr<Experiment> { return std::make_unique<MotorHeatExperiment>(); },
};

}  // namespace teleop
