#include "core/tuning/tune_point.hpp"

#include <algorithm>
#include <cmath>

namespace teleop {
namespace {

/// How long the law remembers: what a push did may come back after the estimator's span.
double memory_of(const VelocityEstimator::Config& velocity, double period_s) {
  constexpr double kDelays_s = 0.02;
  return kDelays_s + (velocity.kind == "mean" ? velocity.mean.samples * period_s : 0.0);
}

/// Frequency and shape at the crossing: of the rated probe nearest to it.
void describe(PointResult& result) {
  if (!result.crossing) return;
  const ProbeResult* nearest = nullptr;
  double distance = 0.0;
  for (const ProbeResult& p : result.probes) {
    const bool rated = p.oscillation && !p.shape.empty() && p.verdict != Verdict::disturbed;
    if (!rated) continue;
    const double away = std::abs(std::log(p.plan.gain / result.crossing->gain));
    if (nearest == nullptr || away < distance) {
      nearest = &p;
      distance = away;
    }
  }
  if (nearest == nullptr) return;
  result.frequency_Hz = nearest->oscillation ? nearest->oscillation->frequency_Hz : 0.0;
  result.shape = nearest->shape;
  result.amplitude_m = nearest->plan.amplitude_m;
}

}  // namespace

double quantum_of(const std::vector<ToolFrame>& frames, std::size_t axis) {
  double quantum = 0.0;
  for (const ToolFrame& frame : frames) {
    quantum = std::max(quantum, frame.quantum_m(static_cast<Eigen::Index>(axis)));
  }
  return quantum;
}

PointResult tune_point(const PointConfig& config,
                       const std::vector<ToolFrame>& frames,
                       const ProbeRunner::Ports& ports,
                       std::vector<ProbeResult> history) {
  MarginalSearch::Config how = config.search;
  how.experiment = config.experiment.experiment;
  how.period_s = ports.period_s;
  how.memory_s = memory_of(config.experiment.velocity, ports.period_s);
  how.quantum_m = quantum_of(frames, config.experiment.axis);
  how.bounds = config.bounds;
  how.amplitude_m = config.amplitude_m > 0.0 ? config.amplitude_m
                                             : MarginalSearch::default_amplitude(how.quantum_m);
  const MarginalSearch search{how};
  LoopUnderTest loop{config.experiment, frames};
  Probe probe{{.bounds = config.bounds, .period_s = ports.period_s}, loop};
  ProbeRunner runner{ports, probe, loop};

  PointResult result{.amplitude_m = how.amplitude_m, .probes = std::move(history)};
  const Analysis analysis{.experiment = how.experiment,
                          .axis = config.experiment.axis,
                          .quantum_m = how.quantum_m,
                          .period_s = ports.period_s};
  MarginalSearch::Step step = search.next(result.probes);
  while (step.plan) {
    const ProbeRunner::Timing timing = runner.run(*step.plan, config.stop_asked);
    result.stopped = probe.outcome().stop == ProbeStop::abandoned;
    if (result.stopped) break;
    runner.think_about([&] {
      result.probes.push_back(
          analyse(analysis, *step.plan, probe.outcome(), timing, probe.trace()));
      if (config.on_probe) config.on_probe(result.probes.back());
      step = search.next(result.probes);
    });
  }
  result.end = step.end;
  result.crossing = step.crossing;
  for (const ProbeResult& p : result.probes) {
    result.arm_seconds += p.timing.arm_seconds;
  }
  describe(result);
  return result;
}

}  // namespace teleop
