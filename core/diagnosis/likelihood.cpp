#include "core/diagnosis/likelihood.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "core/diagnosis/parallel.hpp"
#include "core/diagnosis/predictor.hpp"
#include "core/effects/vocabulary.hpp"

namespace teleop {
namespace {

constexpr double kBaseTolerance = 0.0029;  // of masses and inertias: ±0.5 %, evenly

}  // namespace

Likelihood::Likelihood(const DiagnosisCase& data, const ArmModel& arm, std::size_t threads)
    : data_{&data}, arm_{arm}, prior_{arm, kBaseTolerance}, threads_{threads} {
  set_noise(noise_);
}

void Likelihood::set_noise(const NoiseModel& noise) {
  noise_ = noise;
  std::vector<std::optional<Tether>> made(runs());
  for_each_index(runs(), threads_, [&](std::size_t run) {
    made[run].emplace(arm_, data_->runs[run], data_->period_s, noise);
  });
  tethers_.clear();
  for (std::optional<Tether>& tether : made) {
    if (tether) tethers_.push_back(std::move(*tether));
  }
}

Eigen::VectorXf Likelihood::whitened(std::size_t run,
                                     const MachineModel& model,
                                     const Tether& tether,
                                     JointVector* volume) const {
  const PlantTerms terms = terms_of(model.effects);
  const ArmModel arm = prior_.arm(model.base);
  return whitened(predict({arm, terms}, data_->runs[run], data_->period_s, tether), tether, volume);
}

Eigen::VectorXf Likelihood::whitened(const Prediction& prediction,
                                     const Tether& tether,
                                     JointVector* volume) const {
  const std::vector<JointVector>& raw = prediction.innovations;
  const std::size_t first = std::min(kSettling, raw.size());
  Eigen::VectorXf result{static_cast<Eigen::Index>(3 * (raw.size() - first))};
  if (volume != nullptr) *volume = JointVector::Zero();
  for (std::size_t k = first; k < raw.size(); ++k) {
    const JointMatrix& whitening = tether.steps()[k].whitening;
    JointVector w = whitening * raw[k];
    JointVector scale = whitening.diagonal();
    for (Eigen::Index i = 0; !prediction.apart.empty() && i < w.size(); ++i) {
      const double deviation = prediction.apart[k][i];
      if (deviation <= 0.0) continue;
      w[i] = raw[k][i] / deviation;
      scale[i] = 1.0 / deviation;
    }
    result.segment<3>(static_cast<Eigen::Index>(3 * (k - first))) = w.cast<float>();
    if (volume != nullptr) *volume -= 2.0 * scale.array().log().matrix();
  }
  return result;
}

Prediction Likelihood::prediction(std::size_t run, const MachineModel& model) const {
  const PlantTerms terms = terms_of(model.effects);
  return predict({prior_.arm(model.base), terms}, data_->runs[run], data_->period_s, tethers_[run]);
}

Eigen::VectorXf Likelihood::errors(std::size_t run,
                                   const MachineModel& model,
                                   double* volume) const {
  JointVector volumes = JointVector::Zero();
  Eigen::VectorXf w = whitened(run, model, tethers_[run], &volumes);
  if (volume != nullptr) *volume = volumes.sum();
  return w;
}

Eigen::VectorXf Likelihood::errors_as_rigid(std::size_t run, const MachineModel& model) const {
  Prediction all = prediction(run, model);
  all.apart.clear();
  return whitened(all, tethers_[run]);
}

std::vector<PredictedState> Likelihood::states(std::size_t run, const MachineModel& model) const {
  const PlantTerms terms = terms_of(model.effects);
  const ArmModel arm = prior_.arm(model.base);
  std::vector<PredictedState> all;
  static_cast<void>(predict({arm, terms}, data_->runs[run], data_->period_s, tethers_[run], &all));
  return all;
}

std::vector<Eigen::VectorXf> Likelihood::errors(const MachineModel& model) const {
  std::vector<Eigen::VectorXf> all(runs());
  for_each_index(runs(), threads_, [&](std::size_t run) { all[run] = errors(run, model); });
  return all;
}

JointVector Likelihood::deviance(const MachineModel& model, const NoiseModel& noise) const {
  std::vector<JointVector> parts(runs(), JointVector::Zero());
  for_each_index(runs(), threads_, [&](std::size_t run) {
    const Tether tether{arm_, data_->runs[run], data_->period_s, noise};
    JointVector sum = JointVector::Zero();
    const Eigen::VectorXf w = whitened(run, model, tether, &sum);
    const Eigen::Map<const Eigen::Matrix<float, 3, Eigen::Dynamic>> axes{w.data(), 3, w.size() / 3};
    sum += axes.cast<double>().rowwise().squaredNorm();
    parts[run] = sum;
  });
  JointVector total = JointVector::Zero();
  for (const JointVector& part : parts) {
    total += part;
  }
  return total;
}

namespace {

/// A member of NoiseModel and the range in which it is looked for.
struct NoiseMember {
  JointVector NoiseModel::* member;
  double low;
  double high;
};

constexpr std::array kMembers{
    NoiseMember{&NoiseModel::white, 1e-5, 1e-2},
    NoiseMember{&NoiseModel::coloured, 1e-5, 3e-2},
    NoiseMember{&NoiseModel::reading, 1e-6, 1e-2},
    NoiseMember{&NoiseModel::time_constant, 8e-3, 7e-2},
};

/// Innovations under one tether turned into those under another. With s the distance of the two
/// filters' states: s⁺ = F (s + K e − K′ e′), e′ = e + s_q.
class Refilter {
 public:
  Refilter(const Likelihood& likelihood, const MachineModel& model)
      : likelihood_{&likelihood}, raw_(likelihood.runs()), mobility_(likelihood.runs()) {
    for_each_index(raw_.size(), likelihood.threads(), [&](std::size_t run) {
      raw_[run] = likelihood.prediction(run, model).innovations;
      raw_[run].resize(std::min(raw_[run].size(), kRows));
      mobility_[run] = mobilities(likelihood.arm(), likelihood.data().runs[run]);
    });
  }

  /// −2 log L of each axis over the first rows of all runs.
  [[nodiscard]] JointVector deviance(const NoiseModel& noise) const {
    std::vector<JointVector> parts(raw_.size(), JointVector::Zero());
    for_each_index(raw_.size(), likelihood_->threads(),
                   [&](std::size_t run) { parts[run] = deviance_of(run, noise); });
    JointVector total = JointVector::Zero();
    for (const JointVector& part : parts) {
      total += part;
    }
    return total;
  }

 private:
  static constexpr std::size_t kRows = 4000;  // enough for a level within two percent

  [[nodiscard]] JointVector deviance_of(std::size_t run, const NoiseModel& noise) const {
    const Tether& before = likelihood_->tether(run);
    const double h = likelihood_->data().period_s;
    const std::size_t rows = raw_[run].size();
    const Tether after{likelihood_->arm(), likelihood_->data().runs[run], h, noise, rows};
    JointVector sum = JointVector::Zero();
    JointVector q = JointVector::Zero();
    JointVector qd = JointVector::Zero();
    JointVector d_before = JointVector::Zero();
    JointVector d_after = JointVector::Zero();
    for (std::size_t k = 0; k < rows; ++k) {
      const Tether::Step& old = before.steps()[k];
      const Tether::Step& now = after.steps()[k];
      const JointVector& e = raw_[run][k];
      const JointVector other = e + q;
      if (k >= Likelihood::kSettling) {
        sum += (now.whitening * other).cwiseAbs2() -
               2.0 * now.whitening.diagonal().array().log().matrix();
      }
      q += old.position * e - now.position * other;
      qd += old.velocity * e - now.velocity * other;
      d_before += old.disturbance * e;
      d_after += now.disturbance * other;
      const JointVector jump = h * (mobility_[run][k] * (d_before - d_after));
      q += h * (qd + jump / 2.0);
      qd += jump;
      d_before = before.memory().cwiseProduct(d_before);
      d_after = after.memory().cwiseProduct(d_after);
    }
    return sum;
  }

  const Likelihood* likelihood_;
  std::vector<std::vector<JointVector>> raw_;
  std::vector<std::vector<JointMatrix>> mobility_;
};

}  // namespace

/// Parabolas through three places in one member at a time, of all axes at once: axes are told
/// apart by their own share of the likelihood.
NoiseModel fit_noise(const Likelihood& likelihood,
                     const MachineModel& model,
                     const NoiseModel& start) {
  // Drives that move apart from their links are not in the linear model: they cost simulations.
  const bool rigid = !gives_way(terms_of(model.effects));
  const int sweeps = rigid ? 6 : 4;
  const Refilter refilter{likelihood, model};
  const auto deviance_of = [&](const NoiseModel& noise) {
    return rigid ? refilter.deviance(noise) : likelihood.deviance(model, noise);
  };
  NoiseModel best = start;
  JointVector best_value = deviance_of(best);
  std::array<JointVector, kMembers.size()> width;
  width.fill(JointVector::Constant(0.4));  // in the logarithm
  for (int sweep = 0; sweep < sweeps; ++sweep) {
    const double before = best_value.sum();
    for (std::size_t m = 0; m < kMembers.size(); ++m) {
      const NoiseMember& member = kMembers[m];
      const JointVector centre = best.*member.member;
      const auto at = [&](const JointVector& by) {
        NoiseModel other = best;
        other.*member.member =
            (centre.array() * by.array().exp()).cwiseMax(member.low).cwiseMin(member.high).matrix();
        return other;
      };
      const NoiseModel lower = at(-width[m]);
      const NoiseModel upper = at(width[m]);
      const JointVector low = deviance_of(lower);
      const JointVector high = deviance_of(upper);
      JointVector step;
      for (Eigen::Index i = 0; i < step.size(); ++i) {
        const double w = width[m][i];
        const double bend = low[i] + high[i] - 2.0 * best_value[i];
        const double tilt = (high[i] - low[i]) / 2.0;
        step[i] = bend > 0.0 ? std::clamp(-tilt / bend * w, -2.0 * w, 2.0 * w)
                             : (low[i] < high[i] ? -w : w);
      }
      const NoiseModel trial = at(step);
      const JointVector value = deviance_of(trial);
      for (Eigen::Index i = 0; i < step.size(); ++i) {
        const auto take = [&](const NoiseModel& other, double other_value) {
          if (other_value >= best_value[i]) return;
          (best.*member.member)[i] = (other.*member.member)[i];
          best_value[i] = other_value;
        };
        take(lower, low[i]);
        take(upper, high[i]);
        take(trial, value[i]);
        width[m][i] = std::clamp(std::abs(step[i]), 0.05, 0.4);
      }
    }
    if (before - best_value.sum() < 1.0) break;
  }
  return best;
}

}  // namespace teleop
