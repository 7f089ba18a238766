#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>

#include "core/diagnosis/base_prior.hpp"
#include "core/diagnosis/noise_model.hpp"
#include "core/diagnosis/predictor.hpp"
#include "core/diagnosis/recording.hpp"
#include "core/diagnosis/tether.hpp"
#include "core/effects/effect.hpp"

namespace teleop {

/// A machine as somebody believes it to be.
struct MachineModel {
  std::vector<EffectSpec> effects{};
  BasePrior::Vector base = BasePrior::Vector::Zero();  ///< departures of the rigid body
};

/// How probable recordings are under a model: the tethered simulation's innovations, whitened by
/// their covariance, are independent and of unit variance if the model is right, so that
///
///     −2 log L = Σ |w_k|² + log det S_k.
///
/// The first samples of a run, in which the tether finds the speed, do not count.
class Likelihood {
 public:
  /// Samples in which the tether finds the speed.
  static constexpr std::size_t kSettling = 50;

  Likelihood(const DiagnosisCase& data, const ArmModel& arm, std::size_t threads);

  [[nodiscard]] const DiagnosisCase& data() const noexcept { return *data_; }
  [[nodiscard]] const ArmModel& arm() const noexcept { return arm_; }
  [[nodiscard]] const BasePrior& prior() const noexcept { return prior_; }
  [[nodiscard]] std::size_t threads() const noexcept { return threads_; }
  [[nodiscard]] std::size_t runs() const noexcept { return data_->runs.size(); }
  [[nodiscard]] const NoiseModel& noise() const noexcept { return noise_; }

  /// New gains for all runs.
  void set_noise(const NoiseModel& noise);

  /// Whitened innovations of a run, axis after axis within a sample.
  /// @param volume where given: log det S_k, summed
  [[nodiscard]] Eigen::VectorXf errors(std::size_t run,
                                       const MachineModel& model,
                                       double* volume = nullptr) const;

  /// The same whitened as if no drive moved apart from its link: what compares with a model in
  /// which none does.
  [[nodiscard]] Eigen::VectorXf errors_as_rigid(std::size_t run, const MachineModel& model) const;

  /// Innovations of a run before they are whitened.
  [[nodiscard]] Prediction prediction(std::size_t run, const MachineModel& model) const;

  /// What the tethered simulation goes through.
  [[nodiscard]] std::vector<PredictedState> states(std::size_t run,
                                                   const MachineModel& model) const;
  [[nodiscard]] const Tether& tether(std::size_t run) const noexcept { return tethers_[run]; }

  /// The same of every run.
  [[nodiscard]] std::vector<Eigen::VectorXf> errors(const MachineModel& model) const;

  /// −2 log L of each axis given the axes before it, summed over the runs.
  [[nodiscard]] JointVector deviance(const MachineModel& model, const NoiseModel& noise) const;

 private:
  [[nodiscard]] Eigen::VectorXf whitened(const Prediction& prediction,
                                         const Tether& tether,
                                         JointVector* volume = nullptr) const;

  /// −2 log of the volume of each axis goes to `volume` where that is given.
  [[nodiscard]] Eigen::VectorXf whitened(std::size_t run,
                                         const MachineModel& model,
                                         const Tether& tether,
                                         JointVector* volume = nullptr) const;

  const DiagnosisCase* data_;
  ArmModel arm_;
  BasePrior prior_;
  std::size_t threads_;
  NoiseModel noise_{};
  std::vector<Tether> tethers_;
};

/// The noise that makes the recordings most probable under the model, within what is usual. Other
/// gains turn innovations into others by the linear model of the tether: the plant is simulated
/// once.
[[nodiscard]] NoiseModel fit_noise(const Likelihood& likelihood,
                                   const MachineModel& model,
                                   const NoiseModel& start);

}  // namespace teleop
