#include "scenarios/paper_experiments.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>
#include <vector>

#include <fmt/format.h>

#include "core/model/dynamics.hpp"
#include "core/model/kinematics.hpp"
#include "core/simulation/arm_sim.hpp"

namespace teleop {
namespace {

constexpr std::size_t kY = 1;
constexpr std::size_t kZ = 2;

EffectSpec effect(const char* kind, std::size_t axis, std::map<std::string, double> parameters) {
  return {.kind = kind, .axis = axis, .parameters = std::move(parameters)};
}

/// The arm of an experiment.
struct Make {
  bool stock = false;   ///< drive
  bool coulomb = true;  ///< false: in motion, where Coulomb friction is a constant force
  bool structure = false;
  StockDrive drive = StockDrive::lag;
};

PlantSpec plant_of(const PaperSet& set, const Make& make) {
  PlantSpec plant{.name = "as the reproduction needs it", .watchdog = {.timeout_ms = 0.0}};
  const ArmModel arm = load_arm(plant.arm);
  const ArmParameters& p = arm.parameters();
  const std::array lever{p.l1_m, p.l1_m, p.l2_m};
  for (std::size_t i = 0; i < kJoints; ++i) {
    const double l = lever.at(i);
    plant.effects.push_back(
        effect("viscous_friction", i, {{"coefficient", set[PaperSet::damping] * l * l}}));
    if (make.coulomb) {
      plant.effects.push_back(
          effect("coulomb_friction", i, {{"level", set[PaperSet::coulomb] * l}}));
    }
    const double lag = make.stock ? set[PaperSet::lag_stock] : set[PaperSet::lag_linear];
    if (make.stock && make.drive == StockDrive::voltage) {
      const double full_Nm = set[PaperSet::full_force] * l;
      const double full_A =
          full_Nm / (p.torque_constant_Nm_per_A.at(i) * p.transmission_ratio.at(i));
      plant.effects.push_back(effect("pwm_drive", i,
                                     {{"supply_V", full_A * set[PaperSet::resistance]},
                                      {"carrier_Hz", 20e3},
                                      {"resistance_ohm", set[PaperSet::resistance]},
                                      {"inductance_H", set[PaperSet::inductance]}}));
    } else if (lag > 0.0) {
      plant.effects.push_back(effect("amplifier_lag", i, {{"time_constant", lag}}));
    }
  }
  if (make.structure) {
    const double l = lever[0];
    const double inertia = mass_matrix(arm, JointVector::Zero())(0, 0);
    plant.effects.push_back(effect("transmission_compliance", 0,
                                   {{"stiffness", set[PaperSet::joint_stiffness] * l * l},
                                    {"damping", set[PaperSet::joint_damping] * l * l},
                                    {"drive_inertia", set[PaperSet::motor_mass] * inertia}}));
  }
  return plant;
}

/// A search at home on one arm or a pair of equal ones.
struct Search {
  GainExperiment experiment = GainExperiment::wall;
  std::size_t axis = kY;
  VelocityEstimator::Config velocity{};
  double amplitude_m = 0.0;
};

PointResult search_on(const PlantSpec& plant, const Search& search) {
  SimulatedClock clock;
  std::vector<std::unique_ptr<SimulatedArm>> arms;
  ProbeRunner::Ports ports{.clock = &clock, .time_waits = true};
  std::vector<ToolFrame> frames;
  const std::size_t number = search.experiment == GainExperiment::teleop ? 2 : 1;
  for (std::size_t i = 0; i < number; ++i) {
    arms.push_back(std::make_unique<SimulatedArm>(SimulatedArm::Config{.plant = plant}, clock));
    ports.arms.push_back(arms.back().get());
    frames.push_back({.J = linear_jacobian(arms.back()->model(), JointVector::Zero()),
                      .hold_Nm = gravity_torque(arms.back()->model(), JointVector::Zero()),
                      .counts_per_rev = arms.back()->info().counts_per_rev});
  }
  PointConfig config;
  config.experiment = {
      .experiment = search.experiment, .axis = search.axis, .velocity = search.velocity};
  config.amplitude_m = search.amplitude_m;
  return tune_point(config, frames, ports);
}

PaperRow row_of(PaperRowId id, const PointResult& result, double unit) {
  PaperRow row{.id = id};
  if (!result.crossing) {
    row.note = fmt::format("no margin found: {}", name_of(result.end));
    return row;
  }
  row.ours = result.crossing->gain / unit;
  row.low = result.crossing->low / unit;
  row.high = result.crossing->high / unit;
  if (result.end != SearchEnd::found) row.note = name_of(result.end);
  return row;
}

const char* drive_name(const Make& make) {
  if (!make.stock) return "linear amplifier: current source";
  return make.drive == StockDrive::lag ? "stock: current source of first order"
                                       : "stock: PWM voltage";
}

/// The tool is pressed into the wall: what is looked for is the gain at which an oscillation as
/// large as the penetration neither grows nor dies.
PaperRow wall(PaperRowId id, const PaperSet& set, const Make& make) {
  const PlantSpec plant = plant_of(set, make);
  double stiffness =
      pressed_wall(set, make.stock ? set[PaperSet::lag_stock] : set[PaperSet::lag_linear]);
  PaperRow row;
  constexpr double kAgree = 0.01;
  for (int round = 0; round < 5; ++round) {
    const double amplitude = set[PaperSet::press] / stiffness;
    row = row_of(id, search_on(plant, {.amplitude_m = amplitude}), 1e3);
    if (row.ours <= 0.0) break;
    const double before = stiffness;
    stiffness = std::sqrt(stiffness * row.ours * 1e3);
    if (std::abs(before / (row.ours * 1e3) - 1.0) < kAgree) break;
  }
  row.drive = drive_name(make);
  return row;
}

PaperRow damping(PaperRowId id, const PaperSet& set, const Make& make) {
  VelocityEstimator::Config velocity{.kind = "mean", .mean = {.samples = 100}};
  if (id == PaperRowId::damping_16) velocity = {.kind = "period", .period = {.samples = 16}};
  // The tool with the least mass is the first to oscillate: z at home.
  PaperRow row = row_of(id,
                        search_on(plant_of(set, make), {.experiment = GainExperiment::damping,
                                                        .axis = kZ,
                                                        .velocity = velocity,
                                                        .amplitude_m = 1e-3}),
                        1.0);
  row.drive = drive_name(make);
  return row;
}

/// Smallest gain over the axes.
PointResult worst_loop_gain(const PlantSpec& plant, std::size_t axes) {
  PointResult worst;
  for (std::size_t axis = 0; axis < axes; ++axis) {
    PointResult result =
        search_on(plant, {.experiment = GainExperiment::teleop, .axis = axis, .amplitude_m = 1e-3});
    const bool less =
        result.crossing && (!worst.crossing || result.crossing->gain < worst.crossing->gain);
    if (less || axis == 0) worst = std::move(result);
  }
  return worst;
}

PaperRow loop_gain(const PaperSet& set, const Make& linear, const Make& stock, std::size_t axes) {
  const PointResult high = worst_loop_gain(plant_of(set, linear), axes);
  const PointResult low = worst_loop_gain(plant_of(set, stock), axes);
  PaperRow row{.id = PaperRowId::loop_gain_ratio, .drive = drive_name(stock)};
  if (!high.crossing || !low.crossing) {
    row.note = fmt::format("no margin found: {}, {}", name_of(high.end), name_of(low.end));
    return row;
  }
  row.ours = high.crossing->gain / low.crossing->gain;
  row.low = high.crossing->low / low.crossing->high;
  row.high = high.crossing->high / low.crossing->low;
  row.note = fmt::format("{:.0f} over {:.0f} N/m", high.crossing->gain, low.crossing->gain);
  return row;
}

/// Slow motion of the shipped arm: the smallest change of the first difference of joint 2, as speed
/// of the tool.
double granularity_mm_per_s() {
  const ArmModel arm = load_arm("phantom-1.5");
  VelocityEstimator estimator{
      {.kind = "mean", .mean = {.samples = 1}},
      Eigen::Map<const JointVector>(arm.parameters().encoder_counts_per_rev.data())};
  const double count = 2.0 * std::numbers::pi / arm.parameters().encoder_counts_per_rev[1];
  double least = std::numeric_limits<double>::infinity();
  double before = 0.0;
  for (int tick = 0; tick < 2000; ++tick) {
    JointVector q = JointVector::Zero();
    q[1] = count * std::round(0.01 * 1e-3 * tick / count);
    const double v = estimator.step({.q = q, .dt = 1e-3})[1];
    const double change = std::abs(v - before);
    if (change > 0.0) least = std::min(least, change);
    before = v;
  }
  return least * arm.parameters().l1_m * 1e3;
}

/// Steady acceleration: the mean of 100 shows the speed of so long ago.
double lag_ms() {
  VelocityEstimator estimator{{.kind = "mean", .mean = {.samples = 100}}, JointVector::Ones()};
  double lag = 0.0;
  for (int tick = 0; tick < 400; ++tick) {
    const double t = 1e-3 * tick;
    const JointVector q = JointVector::Constant(t * t / 2.0);
    lag = t - estimator.step({.q = q, .dt = 1e-3})[0];
  }
  return 1e3 * lag;
}

PaperRow exactly(PaperRowId id, double value, const char* drive) {
  return {.id = id, .ours = value, .low = value, .high = value, .drive = drive};
}

}  // namespace

PaperRow do_experiment(PaperRowId row, const PaperSet& set, StockDrive stock) {
  const Make linear{};
  const Make old{.stock = true, .drive = stock};
  switch (row) {
    case PaperRowId::wall_linear:
      return wall(row, set, linear);
    case PaperRowId::wall_stock:
      return wall(row, set, old);
    case PaperRowId::damping_100:
      return damping(row, set, {.stock = true, .coulomb = false, .drive = stock});
    case PaperRowId::damping_16:
      return damping(row, set, {.coulomb = false});
    case PaperRowId::loop_gain_ratio:
      return loop_gain(set, linear, old, kJoints);
    case PaperRowId::heat_linear:
      return exactly(row, casing_rise(set, false), drive_name(linear));
    case PaperRowId::heat_pwm:
      return exactly(row, casing_rise(set, true), "stock: PWM voltage");
    case PaperRowId::velocity_granularity:
      return exactly(row, granularity_mm_per_s(), "none");
    case PaperRowId::velocity_lag:
      return exactly(row, lag_ms(), "none");
  }
  return {};
}

PaperRow structural_loop_gain(const PaperSet& set) {
  return loop_gain(set, {.structure = true}, {.stock = true, .structure = true}, 1);
}

}  // namespace teleop
