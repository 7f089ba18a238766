#pragma once

#include <string>

#include "core/tuning/tune_point.hpp"
#include "scenarios/paper_rows.hpp"

namespace teleop {

/// How the stock drive is modelled in an experiment: what the paper's rows need is not one model.
enum class StockDrive {
  lag,      ///< a current source of first order
  voltage,  ///< the PWM voltage that heats: torque falls with speed
};

/// One row done as an experiment on simulated arms through the port.
struct PaperRow {
  PaperRowId id = PaperRowId::wall_linear;
  double ours = 0.0;
  double low = 0.0;  ///< 90 % interval where a search gives one, else `ours`
  double high = 0.0;
  std::string drive{};  ///< the model of the drive
  std::string note{};   ///< what did not come to an end
};

[[nodiscard]] PaperRow do_experiment(PaperRowId row, const PaperSet& set, StockDrive stock);

/// The loop-gain ratio on the x axis with the structure of the paper's transfer function (form
/// (a)).
[[nodiscard]] PaperRow structural_loop_gain(const PaperSet& set);

}  // namespace teleop
