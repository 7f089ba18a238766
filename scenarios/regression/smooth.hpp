#pragma once

#include <array>
#include <vector>

#include "core/diagnosis/recording.hpp"
#include "core/math/joint_vector.hpp"

namespace teleop {

using Signal = std::vector<JointVector>;

/// Butterworth low pass of order 4, passed forwards and backwards: no phase, 6 dB at the cut-off.
/// It starts from rest at the first value, so that the ends are not to be used.
class ZeroPhaseFilter {
 public:
  /// @pre 0 < cutoff_Hz < 0.5 / period_s
  ZeroPhaseFilter(double cutoff_Hz, double period_s);
  [[nodiscard]] Signal operator()(Signal signal) const;

 private:
  /// One second-order section: y = b0 (x + 2 x⁻ + x⁻⁻) − a1 y⁻ − a2 y⁻⁻.
  struct Section {
    double b0 = 0.0;
    double a1 = 0.0;
    double a2 = 0.0;
  };
  static void pass(const Section& section, Signal& signal);

  std::array<Section, 2> sections_{};
};

/// A run as a regression sees it, sample by sample.
struct SmoothRun {
  double period_s = 1e-3;
  Signal q{};        ///< low-passed, rad
  Signal qd{};       ///< central differences of q
  Signal qdd{};      ///< second differences of q
  Signal command{};  ///< as logged, N m, the mean over the two periods about the sample
};

[[nodiscard]] SmoothRun smooth(const Recording& run,
                               double period_s,
                               const ZeroPhaseFilter& filter);

}  // namespace teleop
