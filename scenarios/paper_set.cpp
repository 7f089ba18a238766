#include "scenarios/paper_set.hpp"

#include <utility>

namespace teleop {
namespace {

constexpr const char* kMotor = "assumed: Maxon RE25, 24 V, 20 W; the paper's winding is not known";

void declare(PaperSet& set, PaperSet::Index index, PaperParameter parameter) {
  set.parameters.at(index) = std::move(parameter);
}

/// What the loops depend on.
void declare_loop(PaperSet& set) {
  declare(set, PaperSet::damping,
          {"damping", 1.115, "N s/m", "the paper reports no friction", {"damping_100"}, 0.2, 4.0});
  declare(set, PaperSet::coulomb,
          {"coulomb",
           0.04,
           "N",
           "assumed: back-drive friction of the maker's data, as quoted by others",
           {},
           0.02,
           0.10});
  declare(set, PaperSet::press,
          {"press", 3.0, "N", "what a finger presses a surface with", {"wall_linear"}, 0.5, 6.0});
  declare(
      set, PaperSet::lag_linear,
      {"lag_linear", 0.0, "s", "paper, 4.2.1: \"more than adequate bandwidth\"", {}, 0.0, 2e-4});
  declare(set, PaperSet::lag_stock,
          {"lag_stock",
           0.15e-3,
           "s",
           "the paper calls the stock drive a black box",
           {"wall_stock"},
           0.0,
           1e-3});
}

/// The x axis as two masses.
void declare_structure(PaperSet& set) {
  declare(set, PaperSet::joint_stiffness,
          {"joint_stiffness",
           5690.0,
           "N/m",
           "paper, 4.3.2, x polynomial, by mass, scaled to the rigid mass",
           {},
           3000.0,
           10000.0});
  declare(set, PaperSet::joint_damping,
          {"joint_damping",
           1.0,
           "N s/m",
           "the same; its two estimates are 0.35 and 4.5",
           {},
           0.35,
           4.5});
  declare(set, PaperSet::motor_mass,
          {"motor_mass",
           0.0154 / 0.0773,
           "1",
           "the same: share of the mass before the joint",
           {},
           0.05,
           0.5});
}

/// Winding and stock drive.
void declare_motor(PaperSet& set) {
  declare(set, PaperSet::resistance, {"resistance", 2.32, "ohm", kMotor, {}, 1.5, 4.0});
  declare(set, PaperSet::inductance, {"inductance", 2.4e-4, "H", kMotor, {}, 1e-4, 5e-4});
  declare(set, PaperSet::torque_constant,
          {"torque_constant", 0.0234, "N m/A", kMotor, {}, 0.015, 0.035});
  declare(set, PaperSet::full_force,
          {"full_force",
           8.5,
           "N",
           "maker's figure for the largest force: full duty of the stock drive",
           {},
           6.0,
           10.0});
  declare(set, PaperSet::carrier,
          {"carrier",
           500.0,
           "Hz",
           "so slow that the current settles within a pulse, as the paper's 1/duty supposes",
           {"heat_pwm"},
           200.0,
           20e3});
}

/// Where the heat goes.
void declare_heat(PaperSet& set) {
  declare(set, PaperSet::copper,
          {"copper", 0.0039, "1/K", "physical constant of copper", {}, 0.0039, 0.0039});
  declare(set, PaperSet::winding_to_housing,
          {"winding_to_housing", 3.1, "K/W", kMotor, {}, 2.5, 5.5});
  declare(set, PaperSet::housing_to_ambient,
          {"housing_to_ambient",
           2.05,
           "K/W",
           "the motor's mount carries heat away",
           {"heat_linear"},
           1.0,
           14.0});
  declare(set, PaperSet::winding_capacity, {"winding_capacity", 4.0, "J/K", kMotor, {}, 2.0, 10.0});
  declare(set, PaperSet::housing_capacity,
          {"housing_capacity", 60.0, "J/K", "assumed: 130 g of steel and magnet", {}, 40.0, 200.0});
}

}  // namespace

PaperSet declared_paper_set() {
  PaperSet set;
  declare_loop(set);
  declare_structure(set);
  declare_motor(set);
  declare_heat(set);
  return set;
}

}  // namespace teleop
