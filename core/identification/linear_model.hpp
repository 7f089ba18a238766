#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

namespace teleop {

/// A linear system with one input and one output in continuous time, ẋ = A x + B u, y = C x + D u:
/// here force in N to displacement in m. The same struct holds the derivative of a system by one of
/// its parameters: then each member is the derivative of that member.
struct LinearModel {
  Eigen::MatrixXd A;
  Eigen::VectorXd B;
  Eigen::RowVectorXd C;
  double D = 0.0;
};

/// A system at some parameters, and its derivative by each of them.
struct Linearised {
  LinearModel model;
  std::vector<LinearModel> derivatives;
};

/// How a loop meets the system: the input is held from one sample to the next, passes a first-order
/// amplifier and arrives whole samples late; the output is read just before the input changes.
struct Sampling {
  double period_s = 1e-3;
  double amplifier_lag_s = 0.0;
  int delay_samples = 0;
};

/// Values at frequencies, and their derivatives: row = frequency, column = parameter.
struct ComplexResponse {
  Eigen::VectorXcd value;
  Eigen::MatrixXcd derivative;
};

/// The exact response of the samples, y_k over u_k, at z = exp(j2πf T):
///
///     G = z^−d (C (zI − Φ)⁻¹ Γ + D/z),   [Φ Γ; 0 1] = exp([A B; 0 0] T)
///
/// so hold, half-sample delay and aliasing need no correction; the lag is one more state. D stands
/// behind one sample because the output is read before the input changes. Derivatives are exact:
/// those of the exponential come from exp([M dM; 0 M]), whose upper right block is d exp(M)
/// [Van Loan 1978].
[[nodiscard]] ComplexResponse sampled_response(const Linearised& system,
                                               const Sampling& sampling,
                                               const Eigen::VectorXd& frequency_Hz);

/// P(j2πf) = C (j2πf I − A)⁻¹ B + D.
[[nodiscard]] Eigen::VectorXcd continuous_response(const LinearModel& model,
                                                   const Eigen::VectorXd& frequency_Hz);

/// What the hold and the delays alone do, z^−d (1 − 1/z) / (jω T (1 + jω τ)): sampled ≈ continuous
/// times this, up to aliasing. For starting values and pictures.
[[nodiscard]] Eigen::VectorXcd hold_response(const Sampling& sampling,
                                             const Eigen::VectorXd& frequency_Hz);

}  // namespace teleop
