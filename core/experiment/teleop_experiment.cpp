#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include "core/base/error.hpp"
#include "core/experiment/experiment.hpp"
#include "core/experiment/scenario.hpp"
#include "core/model/kinematics.hpp"
#include "core/simulation/pair.hpp"

namespace teleop {
namespace {

/// The end of a run that stands for what has settled.
constexpr double kLate_s = 0.5;
constexpr double kTouch_N = 0.1;  ///< below it the wall counts as not touched

/// Mean of squares and the largest.
class Spread {
 public:
  void add(double value) noexcept {
    sum_ += value * value;
    peak_ = std::max(peak_, std::abs(value));
    count_ += 1.0;
  }
  [[nodiscard]] std::optional<double> rms(double unit = 1.0) const {
    if (count_ == 0.0) return std::nullopt;
    return unit * std::sqrt(sum_ / count_);
  }
  [[nodiscard]] std::optional<double> peak(double unit = 1.0) const {
    if (count_ == 0.0) return std::nullopt;
    return unit * peak_;
  }

 private:
  double sum_ = 0.0;
  double peak_ = 0.0;
  double count_ = 0.0;
};

/// What a run adds up, turn by turn.
struct Sums {
  Spread error;
  Spread force;
  Spread late_speed;
  double engaged = 0.0;
  double turns = 0.0;
  Vector3 late_hand = Vector3::Zero();
  Vector3 late_wall = Vector3::Zero();
  double late_turns = 0.0;
};

/// Both arms, a hand at the master, surroundings at the slave, the network between: on simulated
/// time. Tracking compares both tools at the same instant, the master's between its two turns
/// around the slave's.
class TeleopExperiment final : public Experiment {
 public:
  void add_settings(Settings& settings) override {
    settings.add("run.seconds", &seconds_, "how long", {.low = 0.5, .high = 3600.0});
    settings.add("run.hand", &hand_, "at the master: none, hold, reach, press or a trace file");
    settings.add("run.hand_stiffness_N_per_m", &impedance_.stiffness_N_per_m, "of the hand",
                 kNotNegative);
    settings.add("run.hand_damping_Ns_per_m", &impedance_.damping_Ns_per_m, "of the hand",
                 kNotNegative);
    settings.add("run.hand_mass_kg", &impedance_.mass_kg, "that moves with the tool", kNotNegative);
    settings.add("run.environment", &environment_, "at the slave: free, soft or wall");
    settings.add("run.network_delay_ms", &network_delay_ms_, "each way",
                 {.low = 0.0, .high = 200.0});
    settings.add("run.rate_Hz", &station_.rate_Hz, "turns of the loops a second",
                 {.low = 100.0, .high = 5000.0});
    teleop::add_settings(settings, "", station_);
  }

  void check(const Scenario& scenario) const override {
    const Surroundings at_master{.hand = hand_of(scenario)};
    check_integrator(scenario, scenario.plant(), "plant.", at_master);
    check_integrator(scenario, scenario.slave_plant(), scenario.slave_plant_key(),
                     {.contact = contact_of(scenario)});
    // Silence is judged by the age of the newest packet: one that is always older never couples.
    if (station_.supervisor.link_timeout_ms <= network_delay_ms_ + 1e3 / station_.rate_Hz) {
      scenario.refuse("run.network_delay_ms",
                      "packets would always be older than supervisor.link_timeout_ms allows");
    }
    // The parts of a station look at their own configuration when they are made.
    const PositionError law{station_.law, Role::slave};
    const Supervisor supervisor{station_.supervisor, law, 1};
    const Limiter limiter{station_.limits};
    const JointVector counts{
        load_arm(scenario.plant().arm).parameters().encoder_counts_per_rev.data()};
    const VelocityEstimator velocity{station_.velocity, counts};
  }

  [[nodiscard]] Results run(const Scenario& scenario, ExperimentContext& context) const override {
    const auto pair = std::make_unique<SimulatedPair>(config_of(scenario));
    const PositionError law{station_.law, Role::slave};
    const auto turns = static_cast<std::uint64_t>(seconds_ * station_.rate_Hz);
    const auto late = static_cast<std::uint64_t>((seconds_ - kLate_s) * station_.rate_Hz);
    const std::uint64_t every = std::max<std::uint64_t>(1, turns / 2000);
    Sums sums;
    Figure::Curve error_curve{.label = "tracking error"};
    TickRecord master;
    TickRecord slave;
    for (std::uint64_t turn = 0; turn < turns && !context.stopped(); ++turn) {
      pair->step();
      const bool paired = turn > 0 && coupled(master, slave) && coupled(pair->master(), slave);
      if (paired) {
        const Vector3 p_m = 0.5 * (master.p_m + pair->master().p_m) - master.reference_m;
        const Vector3 e =
            law.wanted_slave({.displacement = p_m}).displacement - (slave.p_m - slave.reference_m);
        sums.error.add(e.norm());
        sums.force.add(slave.coupling_N.norm());
        if (turn % every == 0) {
          error_curve.points.emplace_back(static_cast<double>(turn) / station_.rate_Hz,
                                          1e3 * e.norm());
        }
      }
      sums.engaged += paired ? 1.0 : 0.0;
      sums.turns += 1.0;
      master = pair->master();
      slave = pair->slave();
      if (turn >= late) add_late(*pair, sums);
    }
    if (context.figures != nullptr) {
      context.figures->push_back({.name = "tracking",
                                  .title = "Tracking error of the slave",
                                  .x_label = "time (s)",
                                  .y_label = "error (mm)",
                                  .curves = {std::move(error_curve)}});
    }
    return results_of(sums, master, slave);
  }

 private:
  [[nodiscard]] static bool coupled(const TickRecord& a, const TickRecord& b) noexcept {
    const auto engaged = static_cast<std::uint32_t>(Mode::engaged);
    return a.mode == engaged && b.mode == engaged && a.epoch == b.epoch;
  }

  static void add_late(SimulatedPair& pair, Sums& sums) noexcept {
    const SimulatedArm::Truth slave = pair.slave_arm().true_state();
    sums.late_hand += pair.master_arm().true_state().hand_force;
    sums.late_wall += slave.contact_force;
    sums.late_speed.add(slave.v_BT.norm());
    sums.late_turns += 1.0;
  }

  [[nodiscard]] static Results results_of(const Sums& sums,
                                          const TickRecord& master,
                                          const TickRecord& slave) {
    std::optional<double> wall_ratio;
    std::optional<double> wall_force;
    if (sums.late_wall.norm() > kTouch_N * sums.late_turns) {
      wall_ratio = sums.late_hand.norm() / sums.late_wall.norm();
      wall_force = sums.late_wall.norm() / sums.late_turns;
    }
    return {{"tracking_rms_mm", sums.error.rms(1e3), "mm"},
            {"tracking_peak_mm", sums.error.peak(1e3), "mm"},
            {"force_rms_N", sums.force.rms(), "N"},
            {"force_peak_N", sums.force.peak(), "N"},
            {"wall_force_N", wall_force, "N"},
            {"wall_ratio", wall_ratio, "hand over wall"},
            {"late_speed_rms_mm_per_s", sums.late_speed.rms(1e3), "mm/s"},
            {"engaged_share", sums.engaged / std::max(sums.turns, 1.0), "1"},
            {"master_fault", static_cast<double>(master.fault), "number"},
            {"slave_fault", static_cast<double>(slave.fault), "number"}};
  }

  [[nodiscard]] SimulatedPair::Config config_of(const Scenario& scenario) const {
    return {.master = {.plant = scenario.plant(),
                       .hand = hand_,
                       .hand_impedance = impedance_,
                       .seed = scenario.seed()},
            .slave = {.plant = scenario.slave_plant(),
                      .contact = contact_of(scenario),
                      .seed = scenario.seed()},
            .station = station_,
            .network_delay =
                Duration{static_cast<std::int64_t>(std::llround(1e6 * network_delay_ms_))}};
  }

  [[nodiscard]] std::optional<Contact> contact_of(const Scenario& scenario) const {
    try {
      return environment(environment_);
    } catch (const ConfigError& error) {
      scenario.refuse("run.environment", error.what());
    }
  }

  [[nodiscard]] std::optional<Hand> hand_of(const Scenario& scenario) const {
    const ArmModel model = load_arm(scenario.plant().arm);
    try {
      return make_hand(hand_, model, tool_position(model, JointVector::Zero()), scenario.seed(),
                       impedance_);
    } catch (const ConfigError& error) {
      scenario.refuse("run.hand", error.what());
    }
  }

  double seconds_ = 10.0;
  std::string hand_ = "reach";
  Hand::Config impedance_{};
  std::string environment_ = "free";
  double network_delay_ms_ = 0.02;
  StationConfig station_{};
};

}  // namespace

extern const ExperimentKind teleop_experiment;
const ExperimentKind teleop_experiment{
    .name = "teleop",
    .text = "a hand moves the master, the slave follows: tracking, forces, the wall as it is felt",
    .arms = 2,
    .make = []() -> std::unique_ptr<Experiment> { return std::make_unique<TeleopExperiment>(); },
};

}  // namespace teleop
