#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include <Eigen/Core>

#include "core/math/joint_vector.hpp"
#include "scenarios/regression/design.hpp"

namespace teleop {

/// How a regression counts its evidence.
enum class Counting : std::uint8_t {
  samples,     ///< plain BIC: every row is worth one
  correlated,  ///< rows are worth n / correlation length of the residuals
};

/// Which forms explain the rows, by forward selection with swaps: least [Schwarz 1978]
///
///     BIC = Σ_axis n/L log(RSS / n) + |z|² + k log Σ n/L,
///
/// L = 1 or the correlation length of the residuals, z the rigid body's departures. A form joins
/// only if the last run, which no fit sees, is also predicted better.
class ModelChoice {
 public:
  static constexpr std::size_t kMostEffects = 4;

  ModelChoice(const Design& design, Counting counting);

  /// Of each axis, by the residuals of a model.
  struct Noise {
    JointVector variance = JointVector::Ones();
    JointVector length = JointVector::Ones();
  };
  using Choice = std::vector<std::size_t>;  ///< indices of forms

  struct Fitted {
    Eigen::VectorXd coefficients{};  ///< of the rigid body, then of the forms
    JointVector rss = JointVector::Zero();
    double bic = 0.0;
  };

  /// The forms chosen and the noise that they leave.
  [[nodiscard]] const Choice& chosen() const noexcept { return chosen_; }
  [[nodiscard]] const Noise& noise() const noexcept { return noise_; }

  [[nodiscard]] Fitted fit(const Choice& choice, Rows rows) const;
  /// Mean square over variance of the last run, of coefficients fitted to the others, an axis each.
  [[nodiscard]] JointVector left_out(const Choice& choice) const;
  /// Whether the fitted coefficients make an effect of each form.
  [[nodiscard]] bool possible(const Choice& choice, const Fitted& fitted) const;

 private:
  bool add();
  bool swap();
  void measure_noise();
  [[nodiscard]] bool taken(const Form& form, const Choice& by) const;
  [[nodiscard]] double held_out_score(const Choice& choice) const;
  [[nodiscard]] double weight(std::size_t axis) const;

  const Design& design_;
  Counting counting_;
  Choice chosen_;
  Noise noise_{};
};

/// Mean square and correlation length of residuals, axis by axis.
[[nodiscard]] ModelChoice::Noise noise_of(const Design& design, const Eigen::VectorXd& residuals);

}  // namespace teleop
