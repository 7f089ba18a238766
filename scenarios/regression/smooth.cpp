#include "scenarios/regression/smooth.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/base/contract.hpp"

namespace teleop {

ZeroPhaseFilter::ZeroPhaseFilter(double cutoff_Hz, double period_s) {
  expects(cutoff_Hz > 0.0 && cutoff_Hz * period_s < 0.5, "a cut-off below half the sampling rate");
  const double warped = std::tan(std::numbers::pi * cutoff_Hz * period_s);
  for (std::size_t i = 0; i < sections_.size(); ++i) {
    // Poles of the analogue filter at ±22.5° and ±67.5° from the imaginary axis.
    const double damping =
        2.0 * std::sin(std::numbers::pi * (2.0 * static_cast<double>(i) + 1.0) / 8.0);
    const double norm = 1.0 + damping * warped + warped * warped;
    sections_.at(i) = {.b0 = warped * warped / norm,
                       .a1 = 2.0 * (warped * warped - 1.0) / norm,
                       .a2 = (1.0 - damping * warped + warped * warped) / norm};
  }
}

void ZeroPhaseFilter::pass(const Section& section, Signal& signal) {
  JointVector x1 = signal.front();
  JointVector x2 = x1;
  JointVector y1 = x1;
  JointVector y2 = x1;
  for (JointVector& each : signal) {
    const JointVector x = each;
    each = section.b0 * (x + 2.0 * x1 + x2) - section.a1 * y1 - section.a2 * y2;
    x2 = x1;
    x1 = x;
    y2 = y1;
    y1 = each;
  }
}

Signal ZeroPhaseFilter::operator()(Signal signal) const {
  for (int direction = 0; direction < 2; ++direction) {
    for (const Section& section : sections_) {
      pass(section, signal);
    }
    std::reverse(signal.begin(), signal.end());
  }
  return signal;
}

SmoothRun smooth(const Recording& run, double period_s, const ZeroPhaseFilter& filter) {
  const std::size_t n = run.rows();
  expects(n > 2, "a run has rows");
  SmoothRun result{.period_s = period_s, .q = filter(run.q)};
  result.qd.assign(n, JointVector::Zero());
  result.qdd.assign(n, JointVector::Zero());
  result.command = run.tau;
  for (std::size_t k = 1; k + 1 < n; ++k) {
    const JointVector& before = result.q[k - 1];
    const JointVector& after = result.q[k + 1];
    result.qd[k] = (after - before) / (2.0 * period_s);
    result.qdd[k] = (after - 2.0 * result.q[k] + before) / (period_s * period_s);
    result.command[k] = (run.tau[k - 1] + run.tau[k]) / 2.0;
  }
  return result;
}

}  // namespace teleop
