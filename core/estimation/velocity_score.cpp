#include "core/estimation/velocity_score.hpp"

#include <algorithm>
#include <cmath>

#include "core/base/contract.hpp"
#include "core/estimation/smoother.hpp"

namespace teleop {
namespace {

constexpr double kShortestLag_s = -0.020;
constexpr double kLongestLag_s = 0.200;
constexpr double kLagStep_s = 1e-3;
constexpr int kRefinements = 12;

/// Indices of the samples that count.
struct Counted {
  std::size_t first = 0;
  std::size_t end = 0;
};

Counted counted(const VelocityTrace& trace) {
  if (trace.time_s.empty()) return {};
  const double from = trace.time_s.front() + trace.skip_s;
  const double to = trace.time_s.back() - trace.skip_end_s;
  const auto index = [&](auto place) {
    return static_cast<std::size_t>(place - trace.time_s.begin());
  };
  const std::size_t first = index(std::lower_bound(trace.time_s.begin(), trace.time_s.end(), from));
  const std::size_t end = index(std::upper_bound(trace.time_s.begin(), trace.time_s.end(), to));
  return {.first = std::min(first, end), .end = end};
}

/// Σ |v̂(t) − v(t − lag)|² over the samples whose shifted time is within the trace. Shifted times
/// rise, so the place in the record is only ever moved on.
double misfit(const VelocityTrace& trace, const std::vector<Vector3>& estimate, double lag) {
  const Counted range = counted(trace);
  double sum = 0.0;
  double n = 0.0;
  std::size_t i = 0;
  for (std::size_t k = range.first; k < range.end; ++k) {
    const double t = trace.time_s[k] - lag;
    while (i + 1 < trace.time_s.size() && trace.time_s[i + 1] < t) {
      ++i;
    }
    if (t < trace.time_s[i] || i + 1 == trace.time_s.size()) continue;
    const double part = (t - trace.time_s[i]) / (trace.time_s[i + 1] - trace.time_s[i]);
    sum += (estimate[k] - (1.0 - part) * trace.v[i] - part * trace.v[i + 1]).squaredNorm();
    n += 1.0;
  }
  return n > 0.0 ? sum / n : 0.0;
}

double best_lag(std::span<const VelocityTrace> traces,
                std::span<const std::vector<Vector3>> estimates) {
  const auto cost = [&](double lag) {
    double sum = 0.0;
    for (std::size_t i = 0; i < traces.size(); ++i) {
      sum += misfit(traces[i], estimates[i], lag);
    }
    return sum;
  };
  double best = 0.0;
  double least = cost(0.0);
  const int steps = static_cast<int>((kLongestLag_s - kShortestLag_s) / kLagStep_s);
  for (int i = 0; i <= steps; ++i) {
    const double lag = kShortestLag_s + i * kLagStep_s;
    const double here = cost(lag);
    if (here < least) {
      least = here;
      best = lag;
    }
  }
  constexpr double kGolden = 0.6180339887498949;
  double low = best - kLagStep_s;
  double high = best + kLagStep_s;
  for (int i = 0; i < kRefinements; ++i) {
    const double a = high - kGolden * (high - low);
    const double b = low + kGolden * (high - low);
    if (cost(a) < cost(b)) {
      high = b;
    } else {
      low = a;
    }
  }
  return 0.5 * (low + high);
}

}  // namespace

std::vector<Vector3> run_estimator(const VelocityEstimator::Config& config,
                                   const VelocityTrace& trace) {
  VelocityEstimator estimator{config, trace.counts_per_rev};
  std::vector<Vector3> estimates;
  estimates.reserve(trace.samples.size());
  for (std::size_t k = 0; k < trace.samples.size(); ++k) {
    estimates.emplace_back(trace.J[k] * estimator.step(trace.samples[k]));
  }
  return estimates;
}

VelocityScore score(std::span<const VelocityTrace> traces,
                    std::span<const std::vector<Vector3>> estimates) {
  expects(traces.size() == estimates.size(), "one run of the estimator a trace");
  VelocityScore result;
  result.classes = {{{.high_m_per_s = 0.005},
                     {.low_m_per_s = 0.005, .high_m_per_s = 0.020},
                     {.low_m_per_s = 0.020, .high_m_per_s = 0.100},
                     {.low_m_per_s = 0.100}}};
  double total = 0.0;
  double noise = 0.0;
  double samples = 0.0;
  for (std::size_t i = 0; i < traces.size(); ++i) {
    const VelocityTrace& trace = traces[i];
    std::vector<JointVector> error(trace.v.size());
    std::transform(estimates[i].begin(), estimates[i].end(), trace.v.begin(), error.begin(),
                   [](const Vector3& a, const Vector3& b) { return Vector3{a - b}; });
    const auto slow = zero_phase_mean(trace.time_s, error, result.noise_above_Hz);
    const Counted range = counted(trace);
    for (std::size_t k = range.first; k < range.end; ++k) {
      const double size = error[k].norm();
      const double speed = trace.v[k].norm();
      const auto found = std::find_if(result.classes.begin(), result.classes.end(),
                                      [&](const SpeedClass& c) { return speed < c.high_m_per_s; });
      if (found == result.classes.end()) continue;  // not a number
      ++found->samples;
      found->rms_m_per_s += size * size;
      found->worst_m_per_s = std::max(found->worst_m_per_s, size);
      total += size * size;
      noise += (error[k] - slow[k]).squaredNorm();
      samples += 1.0;
    }
  }
  for (SpeedClass& c : result.classes) {
    if (c.samples > 0) c.rms_m_per_s = std::sqrt(c.rms_m_per_s / static_cast<double>(c.samples));
  }
  if (samples > 0.0) {
    result.rms_m_per_s = std::sqrt(total / samples);
    result.noise_m_per_s = std::sqrt(noise / samples);
    result.lag_s = best_lag(traces, estimates);
  }
  return result;
}

}  // namespace teleop
