#include "core/diagnosis/screen.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>

#include "core/base/error.hpp"
#include "core/diagnosis/parallel.hpp"
#include "core/diagnosis/predictor.hpp"
#include "core/effects/kinds.hpp"
#include "core/effects/vocabulary.hpp"
#include "core/model/dynamics.hpp"

namespace teleop {
namespace {

using Eigen::Index;

struct Trial {
  const EffectKind* kind = nullptr;
  std::optional<std::size_t> axis{};
  EffectTrial steps{};
};

std::vector<Trial> all_trials(const MachineUse& use, std::size_t axes) {
  std::vector<Trial> all;
  for (const EffectKind* kind : vocabulary()) {
    if (kind->trials == nullptr) continue;
    const std::size_t places = kind->per_axis ? axes : 1;
    for (std::size_t axis = 0; axis < places; ++axis) {
      for (EffectTrial& steps : kind->trials(use, axis)) {
        all.push_back({.kind = kind,
                       .axis = kind->per_axis ? std::optional{axis} : std::nullopt,
                       .steps = std::move(steps)});
      }
    }
  }
  return all;
}

EffectSpec spec_of(const Trial& trial, const std::vector<double>& values) {
  EffectSpec effect{.kind = std::string{trial.kind->name}, .axis = trial.axis};
  for (std::size_t i = 0; i < values.size(); ++i) {
    const EffectParameter& parameter = trial.kind->parameters[i];
    if (parameter.role == EffectParameter::Role::on_evidence) continue;
    effect.parameters[std::string{parameter.name}] = values[i];
  }
  return effect;
}

/// The effect within the ranges of its parameters; none where nothing is left of it.
std::optional<EffectSpec> bounded(const Trial& trial, std::vector<double> values) {
  bool departs = false;
  bool has_neutral = false;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const EffectParameter& parameter = trial.kind->parameters[i];
    if (!std::isfinite(values[i])) return std::nullopt;
    const bool inside = values[i] >= parameter.range.low && values[i] <= parameter.range.high;
    if (!parameter.neutral) continue;
    has_neutral = true;
    if (!inside && std::isinf(*parameter.neutral)) return std::nullopt;
    if (!inside) {
      // One of several directions that the effect cannot go: it has to do without.
      values[i] = std::max(parameter.range.low, 0.0) +
                  1e-3 * std::abs(trial.steps.front()[i] - *parameter.neutral);
      continue;
    }
    departs = departs || values[i] != *parameter.neutral;
  }
  if (has_neutral && !departs) return std::nullopt;
  return spec_of(trial, values);
}

bool can_join(const std::vector<EffectSpec>& effects, const EffectSpec& more) {
  std::vector<EffectSpec> both = effects;
  both.push_back(more);
  try {
    static_cast<void>(terms_of(both));
    return true;
  } catch (const ConfigError&) {
    return false;
  }
}

}  // namespace

MachineUse use_of(const DiagnosisCase& data, const ArmModel& arm) {
  constexpr std::size_t kStride = 10;  // samples over which a speed is taken
  MachineUse use;
  JointVector low = JointVector::Constant(1e9);
  JointVector high = JointVector::Constant(-1e9);
  JointVector peak = JointVector::Zero();
  JointVector torque = JointVector::Zero();
  JointVector speed = JointVector::Zero();
  JointVector middle = JointVector::Zero();
  double rows = 0.0;
  for (const Recording& run : data.runs) {
    for (std::size_t k = 0; k < run.rows(); ++k) {
      low = low.cwiseMin(run.q[k]);
      high = high.cwiseMax(run.q[k]);
      peak = peak.cwiseMax(run.tau[k].cwiseAbs());
      torque += run.tau[k].cwiseAbs2();
      middle += run.q[k];
      rows += 1.0;
      if (k < kStride) continue;
      speed += ((run.q[k] - run.q[k - kStride]) / (kStride * data.period_s)).cwiseAbs2();
    }
  }
  const JointMatrix M = mass_matrix(arm, middle / rows);
  for (std::size_t i = 0; i < kJoints; ++i) {
    const auto axis = static_cast<Index>(i);
    use[i] = {.torque_peak = peak[axis],
              .torque = std::sqrt(torque[axis] / rows),
              .speed = std::sqrt(speed[axis] / rows),
              .low = low[axis],
              .high = high[axis],
              .inertia = M(axis, axis),
              .drive_inertia = rotor_inertia(i),
              .ratio = arm.parameters().transmission_ratio.at(i)};
  }
  return use;
}

std::vector<Candidate> screen(const Likelihood& likelihood, const Fit& now, const MachineUse& use) {
  const std::vector<Trial> trials = all_trials(use, likelihood.data().axes());
  const Eigen::LDLT<Eigen::MatrixXd> known{now.information};
  std::vector<Candidate> found(trials.size());
  for_each_index(trials.size(), likelihood.threads(), [&](std::size_t t) {
    const Trial& trial = trials[t];
    const auto size = static_cast<Index>(trial.steps.size());
    Eigen::MatrixXd cross = Eigen::MatrixXd::Zero(now.information.rows(), size);
    Eigen::MatrixXd own = Eigen::MatrixXd::Zero(size, size);
    Eigen::VectorXd pull = Eigen::VectorXd::Zero(size);
    std::vector<MachineModel> models(trial.steps.size(), now.model);
    for (std::size_t s = 0; s < trial.steps.size(); ++s) {
      const EffectSpec step = spec_of(trial, trial.steps[s]);
      if (!can_join(now.model.effects, step)) return;
      models[s].effects.push_back(step);
    }
    // A drive that moves apart has innovations of another size: they are compared on one scale.
    const bool splits = gives_way(terms_of(models.front().effects));
    const bool splits_now = gives_way(terms_of(now.model.effects));
    for (std::size_t run = 0; run < likelihood.runs(); ++run) {
      const Eigen::VectorXf& w = now.errors[run];
      const Eigen::VectorXf before = splits_now ? likelihood.errors_as_rigid(run, now.model) : w;
      Eigen::MatrixXf X{w.size(), size};
      for (std::size_t s = 0; s < models.size(); ++s) {
        X.col(static_cast<Index>(s)) = splits ? likelihood.errors_as_rigid(run, models[s]) - before
                                              : likelihood.errors(run, models[s]) - w;
      }
      if (!X.allFinite()) return;
      cross += (now.slopes[run].transpose() * X).cast<double>();
      own += (X.transpose() * X).cast<double>();
      pull += (X.transpose() * w).cast<double>();
    }
    own -= cross.transpose() * known.solve(cross);
    const Eigen::VectorXd share = -own.ldlt().solve(pull);
    if (!share.allFinite()) return;
    const std::vector<double> shares(share.data(), share.data() + size);
    const std::optional<EffectSpec> effect =
        bounded(trial, sized(*trial.kind, trial.steps, shares));
    if (!effect || !can_join(now.model.effects, *effect)) return;
    found[t] = {.effect = *effect, .gain = -pull.dot(share)};
  });
  std::erase_if(found, [](const Candidate& each) { return each.effect.kind.empty(); });
  std::stable_sort(found.begin(), found.end(),
                   [](const Candidate& a, const Candidate& b) { return a.gain > b.gain; });
  return found;
}

}  // namespace teleop
