#pragma once

#include <array>
#include <cstddef>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "core/estimation/velocity_estimator.hpp"
#include "core/math/spatial.hpp"

namespace teleop {

/// A stretch of one arm's readings with the speed that it had.
struct VelocityTrace {
  std::string source{};
  JointVector counts_per_rev = JointVector::Zero();
  std::vector<VelocitySample> samples{};
  std::vector<double> time_s{};  ///< of each sample
  std::vector<Matrix3> J{};      ///< J_v at each sample
  std::vector<Vector3> v{};      ///< true or reference speed of the tool at each sample, m/s
  double skip_s = 0.25;          ///< at the start, while estimators begin: not scored
  double skip_end_s = 0.0;
};

/// J_v times the estimate, sample by sample, m/s.
[[nodiscard]] std::vector<Vector3> run_estimator(const VelocityEstimator::Config& config,
                                                 const VelocityTrace& trace);

/// Error of the tool's estimated velocity, |v̂ − v|, while |v| is within a range. m/s.
struct SpeedClass {
  double low_m_per_s = 0.0;
  double high_m_per_s = std::numeric_limits<double>::infinity();
  std::size_t samples = 0;
  double rms_m_per_s = 0.0;
  double worst_m_per_s = 0.0;
};

struct VelocityScore {
  double lag_s = 0.0;          ///< τ that minimises Σ |v̂(t) − v(t − τ)|²
  double noise_m_per_s = 0.0;  ///< RMS of what v̂ − v has above noise_above_Hz
  double noise_above_Hz = 25.0;
  double rms_m_per_s = 0.0;             ///< of v̂ − v
  std::array<SpeedClass, 4> classes{};  ///< below 5, 5–20, 20–100, above 100 mm/s
};

/// All traces together. `estimates` are run_estimator()'s, one a trace.
[[nodiscard]] VelocityScore score(std::span<const VelocityTrace> traces,
                                  std::span<const std::vector<Vector3>> estimates);

}  // namespace teleop
