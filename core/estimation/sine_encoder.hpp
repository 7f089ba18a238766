#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace teleop {

/// What an encoder with a period counter reads of x(t) = offset + A sin ωt, in counts: whole counts
/// to the nearest, and the 10 MHz ticks between the last two edges with the sign of the last, 0
/// when the 16-bit counter overflowed (ArmState). Edges are at half counts, at their exact
/// instants.
class SineEncoder {
 public:
  struct Config {
    double amplitude_counts = 10.0;  ///< A
    double offset_counts = 0.0;
    double omega_rad_per_s = 1.0;
  };
  struct Reading {
    double counts = 0.0;
    std::int32_t period_ticks = 0;
  };

  explicit SineEncoder(const Config& config);

  [[nodiscard]] Reading read(double time_s) const noexcept;

 private:
  Config config_;
  std::vector<double> edges_;  // phases of one cycle from −π/2, rising half first
};

}  // namespace teleop
