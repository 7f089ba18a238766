#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "core/diagnosis/likelihood.hpp"
#include "core/diagnosis/search.hpp"
#include "core/diagnosis/torque_smoother.hpp"
#include "core/math/joint_vector.hpp"

namespace teleop {

/// Mean of the torque that a model misses, over the rows that fall into a cell.
struct MissingMean {
  double mean = 0.0;       ///< N m
  double deviation = 0.0;  ///< of the mean, from a bootstrap over blocks of time
  std::size_t rows = 0;
  std::size_t blocks = 0;  ///< that hold rows of the cell

  /// Seen in several blocks, and further from zero than chance takes it.
  [[nodiscard]] bool significant() const noexcept;
};

/// Missing torque of one axis over its angle and speed; cells row by row, a row a speed.
struct MissingMap {
  double q_low = 0.0;
  double q_high = 0.0;
  double v_most = 0.0;  ///< speeds go from −v_most to v_most
  std::size_t columns = 0;
  std::size_t rows = 0;
  std::vector<MissingMean> cells{};
};

/// Missing torque of one axis over one quantity, in bins of equal counts.
struct MissingProfile {
  std::string quantity{};            ///< "speed"
  std::string unit{};                ///< "rad/s"
  std::vector<double> middles{};     ///< of the quantity
  std::vector<MissingMean> means{};  ///< a bin each
  double share = 0.0;  ///< of the missing torque's variance that follows the quantity, 0 to 1
};

/// How one model misses one axis.
struct AxisMiss {
  double torque = 0.0;  ///< RMS of the smoothed missing torque, N m
  MissingMean mean{};   ///< over everything
  MissingMap map{};
  std::vector<MissingProfile> profiles{};
  double slow = 0.0;                ///< mean torque against the direction in slow motion, N m
  double fast = 0.0;                ///< and in fast
  std::vector<double> run_power{};  ///< mean square of the whitened innovations, a run each
  std::vector<double> spectrum{};   ///< of the whitened innovations; 1: noise
};

/// Where a model and recordings differ, before and after the correction. Maps and profiles come
/// from the torque that the tether's smoother gives, spectra and runs from whitened innovations.
struct Localisation {
  std::vector<double> f_Hz{};  ///< of the spectra
  std::array<AxisMiss, kJoints> nominal{};
  std::array<AxisMiss, kJoints> corrected{};
  /// The same rows that the maps were made of, a run each; nothing where a model runs away.
  std::vector<std::vector<TorqueSmoother::Row>> nominal_rows{};
  std::vector<std::vector<TorqueSmoother::Row>> corrected_rows{};
  std::string where{};  ///< what the correction took away, in words; empty: nothing
  /// Runs and frequencies of what is left on each axis, in words; empty: nothing.
  std::array<std::string, kJoints> left_over{};
  std::size_t axis = 0;  ///< that the nominal model misses most
};

/// Looks where the nominal and the best model miss the recordings. The likelihood is to have the
/// noise of the best explanation, and keeps it.
[[nodiscard]] Localisation localise(const Likelihood& likelihood, const SearchResult& found);

}  // namespace teleop
