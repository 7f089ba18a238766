#include "core/tuning/probe_result.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace teleop {
namespace {

constexpr double kSkip_s = 0.004;          ///< after the push: delays and lags empty
constexpr double kMostLostTurns = 0.03;    ///< share
constexpr double kLimitCycleCounts = 3.0;  ///< largest amplitude of one
constexpr double kTelling = 0.3;           ///< of the amplitude asked for
constexpr std::size_t kMostSamples = 1200;
constexpr double kSamplesAPeriod = 40.0;

/// Channels of a trace, thinned by averaging so that a period has no more samples than it needs.
struct Channels {
  std::vector<double> t_s;
  std::array<std::array<std::vector<double>, 3>, kMostArms> d;
};

Channels channels_of(const ProbeTrace& trace,
                     std::size_t arms,
                     const ProbePlan& plan,
                     double period_s) {
  const auto skip = static_cast<std::size_t>(kSkip_s / period_s);
  Channels c;
  if (trace.size <= skip) return c;
  const std::size_t rest = trace.size - skip;
  const double wanted = std::max(plan.period_s / period_s / kSamplesAPeriod,
                                 static_cast<double>(rest) / static_cast<double>(kMostSamples));
  const std::size_t block = std::max<std::size_t>(1, static_cast<std::size_t>(wanted));
  for (std::size_t from = skip; from + block <= trace.size; from += block) {
    double t = 0.0;
    std::array<Vector3, kMostArms> sum{Vector3::Zero(), Vector3::Zero()};
    for (std::size_t k = from; k < from + block; ++k) {
      t += trace.t_s[k];
      for (std::size_t i = 0; i < arms; ++i) {
        sum[i] += trace.displacement[i][k];
      }
    }
    const auto n = static_cast<double>(block);
    c.t_s.push_back(t / n);
    for (std::size_t i = 0; i < arms; ++i) {
      for (std::size_t axis = 0; axis < 3; ++axis) {
        c.d[i][axis].push_back(sum[i][static_cast<Eigen::Index>(axis)] / n);
      }
    }
  }
  return c;
}

std::vector<ShapeEntry> shape_of(const Channels& c, std::size_t arms, const FreeMode& mode) {
  std::vector<ShapeEntry> shape;
  ShapeEntry largest;
  for (std::size_t i = 0; i < arms; ++i) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const Phasor p = phasor_of({.t_s = c.t_s, .y = c.d[i][axis]}, mode);
      shape.push_back({.arm = i,
                       .axis = axis,
                       .ratio = std::hypot(p.in_phase, p.quadrature),
                       .phase_rad = std::atan2(-p.quadrature, p.in_phase)});
      if (shape.back().ratio > largest.ratio) largest = shape.back();
    }
  }
  for (ShapeEntry& entry : shape) {
    entry.ratio = largest.ratio > 0.0 ? entry.ratio / largest.ratio : 0.0;
    entry.phase_rad = std::remainder(entry.phase_rad - largest.phase_rad, 2.0 * std::numbers::pi);
  }
  return shape;
}

/// Largest tool amplitude for each unit of the fitted signal.
double leverage(const Channels& c,
                const std::vector<double>& signal,
                const Analysis& how,
                std::size_t arms,
                const FreeMode& mode) {
  const Phasor whole = phasor_of({.t_s = c.t_s, .y = signal}, mode);
  double largest = 0.0;
  for (std::size_t i = 0; i < arms; ++i) {
    const Phasor p = phasor_of({.t_s = c.t_s, .y = c.d[i][how.axis]}, mode);
    largest = std::max(largest, std::hypot(p.in_phase, p.quadrature));
  }
  return largest / std::max(std::hypot(whole.in_phase, whole.quadrature), 1e-12);
}

FreeMode mode_of(const Oscillation& o) {
  return {.growth_per_s = o.growth_per_s,
          .omega_rad_per_s = 2.0 * std::numbers::pi * o.frequency_Hz};
}

void find_oscillations(const Channels& c,
                       const Analysis& how,
                       double amplitude_m,
                       ProbeResult& result) {
  const bool pair = how.experiment == GainExperiment::teleop;
  const std::size_t arms = pair ? 2 : 1;
  std::vector<double> signal = c.d[0][how.axis];
  if (pair) {
    std::transform(signal.begin(), signal.end(), c.d[1][how.axis].begin(), signal.begin(),
                   std::minus<>{});
  }
  const double noise = how.quantum_m * std::sqrt((pair ? 2.0 : 1.0) / 12.0);
  const Record record{.t_s = c.t_s, .y = signal};
  std::vector<Oscillation> found = fit_oscillations(record, noise, amplitude_m);
  if (found.empty()) return;
  double lever = 1.0;
  if (pair) {
    lever = leverage(c, signal, how, arms, mode_of(found.front()));
    found = fit_oscillations(record, noise, amplitude_m / lever);
    if (found.empty()) return;
  }
  Oscillation& o = found.front();
  o.amplitude_start *= lever;
  o.amplitude_end *= lever;
  o.amplitude_here *= lever;
  result.oscillation = o;
  result.others.assign(found.begin() + 1, found.end());
  result.shape = shape_of(c, arms, mode_of(o));
}

/// How often a motion turned back by more than two counts.
int turns_back(const std::vector<double>& x, double quantum_m) {
  int turns = 0;
  double direction = 0.0;
  double extreme = x.empty() ? 0.0 : x.front();
  for (const double value : x) {
    if (direction * (value - extreme) > 0.0) extreme = value;
    if (std::abs(value - extreme) < 2.0 * quantum_m) continue;
    if (direction != 0.0) ++turns;
    direction = value > extreme ? 1.0 : -1.0;
    extreme = value;
  }
  return turns;
}

Verdict judge(const ProbeResult& result, double quantum_m, int turned_back) {
  const ProbeStop stop = result.outcome.stop;
  const double turns = std::max(result.outcome.ticks, 1);
  const bool lost = result.timing.missed_turns > kMostLostTurns * turns;
  const bool useless =
      stop == ProbeStop::restless || stop == ProbeStop::fault || stop == ProbeStop::abandoned;
  if (useless || lost) return Verdict::disturbed;
  const bool ran_away = is_bound(stop) || stop == ProbeStop::grew;
  const bool weak = result.outcome.peak_swing_m < kTelling * result.plan.amplitude_m;
  if (!result.oscillation || !result.oscillation->is_rated()) {
    if (ran_away) return turned_back < 2 ? Verdict::overshot : Verdict::grows;
    return weak || stop == ProbeStop::time ? Verdict::undershot : Verdict::quiet;
  }
  const Oscillation& o = *result.oscillation;
  const double largest = std::max(o.amplitude_start, o.amplitude_end);
  if (largest < kLimitCycleCounts * quantum_m) return weak ? Verdict::undershot : Verdict::small;
  return o.growth_per_s > 0.0 ? Verdict::grows : Verdict::decays;
}

}  // namespace

std::string_view name_of(Verdict verdict) noexcept {
  switch (verdict) {
    case Verdict::quiet:
      return "quiet";
    case Verdict::decays:
      return "decays";
    case Verdict::grows:
      return "grows";
    case Verdict::small:
      return "small";
    case Verdict::overshot:
      return "overshot";
    case Verdict::undershot:
      return "undershot";
    case Verdict::disturbed:
      return "disturbed";
  }
  return "unknown";
}

ProbeResult analyse(const Analysis& how,
                    const ProbePlan& plan,
                    const ProbeOutcome& outcome,
                    const ProbeRunner::Timing& timing,
                    const ProbeTrace& trace) {
  ProbeResult result{.plan = plan, .outcome = outcome, .timing = timing};
  const std::size_t arms = how.experiment == GainExperiment::teleop ? 2 : 1;
  const Channels c = channels_of(trace, arms, plan, how.period_s);
  if (!c.t_s.empty()) find_oscillations(c, how, plan.amplitude_m, result);
  const int turned_back = turns_back(c.d[0][how.axis], how.quantum_m);
  result.verdict = judge(result, how.quantum_m, turned_back);
  return result;
}

}  // namespace teleop
