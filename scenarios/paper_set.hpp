#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

namespace teleop {

/// One number that the reproduction of [Cavusoglu 2002] needs and the paper does not give, or gives
/// only in passing.
struct PaperParameter {
  std::string name;
  double value = 0.0;
  std::string unit;
  std::string source;                    ///< the paper, a data sheet, or why it was assumed
  std::vector<std::string> fitted_to{};  ///< ids of the rows of the paper that it was chosen by
  double low = 0.0;                      ///< what is physically plausible: bounds of --fit
  double high = 0.0;
};

/// The declared set. One set serves every row.
struct PaperSet {
  enum Index : std::size_t {
    damping,          ///< physical damping of the tool, an axis
    coulomb,          ///< Coulomb friction at the tool
    press,            ///< of the user's finger on the virtual wall
    lag_linear,       ///< of the linear amplifier
    lag_stock,        ///< of the stock drive
    joint_stiffness,  ///< of the x axis' structure
    joint_damping,
    motor_mass,  ///< share of the x axis' mass before the joint
    resistance,
    inductance,
    torque_constant,
    full_force,  ///< of the stock drive, at full duty
    carrier,
    copper,
    winding_to_housing,
    housing_to_ambient,
    winding_capacity,
    housing_capacity,
    count
  };

  std::array<PaperParameter, count> parameters;

  [[nodiscard]] double operator[](Index i) const { return parameters.at(i).value; }
};

[[nodiscard]] PaperSet declared_paper_set();

}  // namespace teleop
