#include "scenarios/paper_set.hpp"

namespace teleop {

PaperSet declared_paper_set() {
  constexpr const char* kMotor =
      "assumed: Maxon RE25, 24 V, 20 W; the paper's winding is not known";
  PaperSet set;
  const auto is = [&](PaperSet::Index i, PaperParameter parameter) {
    set.parameters.at(i) = std::move(parameter);
  };
  is(PaperSet::damping,
     {"damping", 1.115, "N s/m", "the paper reports no friction", {"damping_100"}, 0.2, 4.0});
  is(PaperSet::coulomb, {"coulomb",
                         0.04,
                         "N",
                         "assumed: back-drive friction of the maker's data, as quoted by others",
                         {},
                         0.02,
                         0.10});
  is(PaperSet::press,
     {"press", 3.0, "N", "what a finger presses a surface with", {"wall_linear"}, 0.5, 6.0});
  is(PaperSet::lag_linear,
     {"lag_linear", 0.0, "s", "paper, 4.2.1: \"more than adequate bandwidth\"", {}, 0.0, 2e-4});
  is(PaperSet::lag_stock, {"lag_stock",
                           0.15e-3,
                           "s",
                           "the paper calls the stock drive a black box",
                           {"wall_stock"},
                           0.0,
                           1e-3});
  is(PaperSet::joint_stiffness, {"joint_stiffness",
                                 5690.0,
                                 "N/m",
                                 "paper, 4.3.2, x polynomial, by mass, scaled to the rigid mass",
                                 {},
                                 3000.0,
                                 10000.0});
  is(PaperSet::joint_damping, {"joint_damping",
                               1.0,
                               "N s/m",
                               "the same; its two estimates are 0.35 and 4.5",
                               {},
                               0.35,
                               4.5});
  is(PaperSet::motor_mass, {"motor_mass",
                            0.0154 / 0.0773,
                            "1",
                            "the same: share of the mass before the joint",
                            {},
                            0.05,
                            0.5});
  is(PaperSet::resistance, {"resistance", 2.32, "ohm", kMotor, {}, 1.5, 4.0});
  is(PaperSet::inductance, {"inductance", 2.4e-4, "H", kMotor, {}, 1e-4, 5e-4});
  is(PaperSet::torque_constant, {"torque_constant", 0.0234, "N m/A", kMotor, {}, 0.015, 0.035});
  is(PaperSet::full_force, {"full_force",
                            8.5,
                            "N",
                            "maker's figure for the largest force: full duty of the stock drive",
                            {},
                            6.0,
                            10.0});
  is(PaperSet::carrier,
     {"carrier",
      500.0,
      "Hz",
      "so slow that the current settles within a pulse, as the paper's 1/duty supposes",
      {"heat_pwm"},
      200.0,
      20e3});
  is(PaperSet::copper,
     {"copper", 0.0039, "1/K", "physical constant of copper", {}, 0.0039, 0.0039});
  is(PaperSet::winding_to_housing, {"winding_to_housing", 3.1, "K/W", kMotor, {}, 2.5, 5.5});
  is(PaperSet::housing_to_ambient, {"housing_to_ambient",
                                    2.05,
                                    "K/W",
                                    "the motor's mount carries heat away",
                                    {"heat_linear"},
                                    1.0,
                                    14.0});
  is(PaperSet::winding_capacity, {"winding_capacity", 4.0, "J/K", kMotor, {}, 2.0, 10.0});
  is(PaperSet::housing_capacity,
     {"housing_capacity", 60.0, "J/K", "assumed: 130 g of steel and magnet", {}, 40.0, 200.0});
  return set;
}

}  // namespace teleop
