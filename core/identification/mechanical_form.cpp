#include "core/identification/mechanical_form.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>

#include <Eigen/QR>

#include "core/base/contract.hpp"

namespace teleop {
namespace {

using Complex = std::complex<double>;

constexpr double kTwoPi = 2.0 * std::numbers::pi;
constexpr double kPerSecond = 1e3;      ///< speeds in m/ms, so that entries of A T are of one size
constexpr double kNormal95 = 1.6449;    ///< 90 % of a normal variable lie within ± this
constexpr double kChiSquare99 = 6.635;  ///< of one degree of freedom
constexpr double kTrustInStart = 0.03;  ///< starting values lie on a grid: not exact to the noise
constexpr double kLargestLogarithm = 60;  ///< keeps e^θ finite while the solver gropes

struct Start {
  double misfit = 0.0;
  MechanicalParameters parameters;
};

/// What all starting values share: lines, and what each is weighted with.
struct WeightedLines {
  Eigen::ArrayXcd z;
  Eigen::ArrayXcd late;   ///< delay and amplifier, over the weight
  Eigen::ArrayXcd right;  ///< measured values, over the weight
  double period_s = 0.0;

  WeightedLines(const MeasuredResponse& data, const Sampling& sampling)
      : period_s{sampling.period_s} {
    const Eigen::ArrayXcd s = Complex{0.0, kTwoPi} * data.frequency_Hz.cast<Complex>().array();
    const Eigen::ArrayXd trust = data.deviation.array() + kTrustInStart * data.value.array().abs();
    z = (s * period_s).exp();
    late = (-s * (period_s * sampling.delay_samples)).exp() /
           ((1.0 + s * sampling.amplifier_lag_s) * trust);
    right = data.value.array() / trust;
  }
};

/// The sampled response of 1/((s − p)(s − p*)) behind a hold.
Eigen::ArrayXcd held_mode(Complex pole, const Eigen::ArrayXcd& z, double period_s) {
  const Complex step = std::exp(pole * period_s);
  const Complex residue = (step - 1.0) / pole;
  return (residue.imag() * z - (residue * std::conj(step)).imag()) /
         (pole.imag() * (z * (z - 2.0 * step.real()) + std::norm(step)));
}

/// The sampled response of 1/(s (s + c)) behind a hold, of 1/s² for c = 0.
Eigen::ArrayXcd held_rigid(double c, const Eigen::ArrayXcd& z, double period_s) {
  if (c == 0.0) return 0.5 * period_s * period_s * (z + 1.0) / (z - 1.0).square();
  const double step = std::exp(-c * period_s);
  return (period_s / (z - 1.0) - (1.0 - step) / (c * (z - step))) / c;
}

/// The poles that a starting value assumes.
struct Poles {
  double rigid_per_s = 0.0;  ///< b_0/M
  Complex mode;
};

/// 1/M, m2/(M m1) and 1/k_t by linear least squares for assumed poles.
std::optional<Start> start_at(MechanicalForm form, const WeightedLines& data, const Poles& poles) {
  const Eigen::Index lines = data.z.size();
  const Eigen::Index unknowns = form == MechanicalForm::a ? 2 : 3;
  Eigen::MatrixXcd columns{lines, unknowns};
  columns.col(0) = data.late * held_rigid(poles.rigid_per_s, data.z, data.period_s);
  columns.col(1) = data.late * held_mode(poles.mode, data.z, data.period_s);
  if (unknowns == 3) columns.col(2) = data.late / data.z;
  Eigen::MatrixXd A{2 * lines, unknowns};
  A << columns.real(), columns.imag();
  Eigen::VectorXd y{2 * lines};
  y << data.right.real(), data.right.imag();
  const Eigen::VectorXd x = A.colPivHouseholderQr().solve(y);
  if (!(x.minCoeff() > 0.0)) return std::nullopt;

  const double mass = 1.0 / x(0);
  const double m1 = mass / (1.0 + x(1) / x(0));
  const double reduced = m1 * (mass - m1) / mass;
  return Start{.misfit = (A * x - y).squaredNorm(),
               .parameters = {.m1_kg = m1,
                              .m2_kg = mass - m1,
                              .k_N_per_m = reduced * std::norm(poles.mode),
                              .b_Ns_per_m = -2.0 * poles.mode.real() * reduced,
                              .k_t_N_per_m = unknowns == 3 ? 1.0 / x(2) : 0.0,
                              .b_0_Ns_per_m = poles.rigid_per_s * mass}};
}

/// The best of the grid, one a natural frequency, best first.
std::vector<MechanicalParameters> starts(const MechanicalFamily& family,
                                         const MeasuredResponse& data,
                                         const Sampling& sampling) {
  constexpr int kFrequencies = 200;
  const std::vector<double> rigid =
      family.has_ground_damper ? std::vector{2.0, 20.0} : std::vector{0.0};
  const WeightedLines lines{data, sampling};
  const double low = data.frequency_Hz.minCoeff();
  const double ratio = 1.5 * data.frequency_Hz.maxCoeff() / low;
  std::vector<Start> found;
  for (int i = 0; i < kFrequencies; ++i) {
    const double natural = kTwoPi * low * std::pow(ratio, (i + 0.5) / kFrequencies);
    std::optional<Start> best;
    for (const double damping_ratio : {0.01, 0.04, 0.15, 0.6}) {
      const Complex mode = std::polar(natural, std::acos(-damping_ratio));
      for (const double rigid_per_s : rigid) {
        const auto start = start_at(family.form, lines, {.rigid_per_s = rigid_per_s, .mode = mode});
        if (start && (!best || start->misfit < best->misfit)) best = start;
      }
    }
    if (best) found.push_back(*best);
  }
  std::sort(found.begin(), found.end(),
            [](const Start& a, const Start& b) { return a.misfit < b.misfit; });
  std::vector<MechanicalParameters> result;
  for (std::size_t i = 0; i < std::min<std::size_t>(3, found.size()); ++i) {
    result.push_back(found[i].parameters);
  }
  if (!result.empty()) return result;
  // No mode to be seen: a rigid mass of which a tenth sits on a spring beyond the last line.
  const double omega = kTwoPi * data.frequency_Hz(0);
  const double mass = 1.0 / (omega * omega * std::abs(data.value(0)));
  const double far = kTwoPi * 1.5 * data.frequency_Hz.maxCoeff();
  return {{.m1_kg = 0.9 * mass,
           .m2_kg = 0.1 * mass,
           .k_N_per_m = 0.09 * mass * far * far,
           .b_Ns_per_m = 0.02 * mass * far,
           .k_t_N_per_m = mass * far * far,
           .b_0_Ns_per_m = mass}};
}

Estimate estimate(std::string_view name, std::string_view unit, double theta, double variance) {
  const double value = std::exp(std::clamp(theta, -kLargestLogarithm, kLargestLogarithm));
  const double deviation = std::sqrt(variance);
  const bool determined = deviation < 1.0;
  const double reach = std::min(kNormal95 * deviation, kLargestLogarithm);
  return {.name = name,
          .unit = unit,
          .value = value,
          .deviation = value * std::min(deviation, kLargestLogarithm),
          .low = value * std::exp(-reach),
          .high = value * std::exp(reach),
          .determined = determined};
}

std::vector<Estimate> estimates(const MechanicalFamily& family, const ResponseFit& fit) {
  struct Name {
    std::string_view name;
    std::string_view unit;
  };
  std::vector<Name> names{{"m1", "kg"}, {"m2", "kg"}, {"k", "N/m"}, {"b", "N s/m"}};
  if (family.form == MechanicalForm::b) names.push_back({"k_t", "N/m"});
  if (family.has_ground_damper) names.push_back({"b_0", "N s/m"});
  std::vector<Estimate> result;
  for (std::size_t i = 0; i < names.size(); ++i) {
    const auto at = static_cast<Eigen::Index>(i);
    result.push_back(estimate(names[i].name, names[i].unit, fit.theta(at), fit.covariance(at, at)));
  }
  return result;
}

double mode_Hz(const MechanicalParameters& p) {
  return std::sqrt(p.k_N_per_m * (1.0 / p.m1_kg + 1.0 / p.m2_kg)) / kTwoPi;
}

/// The best fit from several starting values.
ResponseFit best_fit(const MechanicalFamily& family,
                     const std::vector<MechanicalParameters>& from,
                     const MeasuredResponse& data,
                     const Sampling& sampling) {
  ResponseFit best;
  bool first = true;
  for (const MechanicalParameters& start : from) {
    ResponseFit fit = fit_response(family, family.pack(start), data, sampling);
    if (first || fit.cost < best.cost) best = std::move(fit);
    first = false;
  }
  return best;
}

}  // namespace

Linearised MechanicalFamily::operator()(const Eigen::VectorXd& theta) const {
  const MechanicalParameters p = unpack(theta);
  // Forces between and on the masses, as rows of accelerations of (x1, v1, x2, v2), v in m/ms.
  const LinearModel zero{.A = Eigen::MatrixXd::Zero(4, 4),
                         .B = Eigen::VectorXd::Zero(4),
                         .C = Eigen::RowVectorXd::Zero(4),
                         .D = 0.0};
  LinearModel spring = zero;
  LinearModel damper = zero;
  LinearModel ground = zero;
  LinearModel tendon = zero;
  const double k_N_per_m = p.k_N_per_m / kPerSecond;
  spring.A.row(1) << -k_N_per_m, 0.0, k_N_per_m, 0.0;
  damper.A.row(1) << 0.0, -p.b_Ns_per_m, 0.0, p.b_Ns_per_m;
  for (LinearModel* pair : {&spring, &damper}) {
    pair->A.row(3) = -pair->A.row(1) / p.m2_kg;
    pair->A.row(1) /= p.m1_kg;
  }
  ground.A(1, 1) = -p.b_0_Ns_per_m / p.m1_kg;
  if (form == MechanicalForm::b) tendon.D = 1.0 / p.k_t_N_per_m;

  Linearised system{.model = zero, .derivatives = {zero, zero, spring, damper}};
  LinearModel& model = system.model;
  model.A = spring.A + damper.A + ground.A;
  model.A(0, 1) = kPerSecond;
  model.A(2, 3) = kPerSecond;
  model.B(1) = 1.0 / (p.m1_kg * kPerSecond);
  model.C(0) = 1.0;
  model.D = tendon.D;
  // ∂/∂ln m: the accelerations of that mass go as 1/m.
  system.derivatives[0].A.row(1) = -model.A.row(1);
  system.derivatives[0].B = -model.B;
  system.derivatives[1].A.row(3) = -model.A.row(3);
  if (form == MechanicalForm::b) {
    tendon.D = -tendon.D;
    system.derivatives.push_back(tendon);
  }
  if (has_ground_damper) system.derivatives.push_back(ground);
  return system;
}

Eigen::VectorXd MechanicalFamily::pack(const MechanicalParameters& p) const {
  std::vector<double> values{p.m1_kg, p.m2_kg, p.k_N_per_m, p.b_Ns_per_m};
  if (form == MechanicalForm::b) values.push_back(p.k_t_N_per_m);
  if (has_ground_damper) values.push_back(p.b_0_Ns_per_m);
  return Eigen::Map<Eigen::ArrayXd>{values.data(), static_cast<Eigen::Index>(values.size())}.log();
}

MechanicalParameters MechanicalFamily::unpack(const Eigen::VectorXd& theta) const {
  const Eigen::VectorXd values = theta.array().max(-kLargestLogarithm).min(kLargestLogarithm).exp();
  Eigen::Index next = 4;
  MechanicalParameters p{
      .m1_kg = values(0), .m2_kg = values(1), .k_N_per_m = values(2), .b_Ns_per_m = values(3)};
  if (form == MechanicalForm::b) p.k_t_N_per_m = values(next++);
  if (has_ground_damper) p.b_0_Ns_per_m = values(next);
  return p;
}

TransferFunction transfer_function(MechanicalForm form, const MechanicalParameters& p) {
  expects(p.b_0_Ns_per_m == 0.0, "free to move");
  const double mass = p.m1_kg + p.m2_kg;
  TransferFunction P{
      .numerator = Eigen::Vector3d{p.m2_kg, p.b_Ns_per_m, p.k_N_per_m},
      .denominator = Eigen::Vector3d{p.m1_kg * p.m2_kg, mass * p.b_Ns_per_m, mass * p.k_N_per_m}};
  if (form == MechanicalForm::a) return P;
  Eigen::VectorXd numerator = Eigen::VectorXd::Zero(5);
  numerator.head(3) = P.denominator;
  numerator.tail(3) += p.k_t_N_per_m * P.numerator;
  P.numerator = numerator;
  P.denominator *= p.k_t_N_per_m;
  return P;
}

MechanicalFit fit_mechanical(MechanicalForm form,
                             const MeasuredResponse& data,
                             const Sampling& sampling) {
  MechanicalFit result{.family = {.form = form}, .parameters = {}, .estimates = {}, .fit = {}};
  result.fit = best_fit(result.family, starts(result.family, data, sampling), data, sampling);

  const MechanicalFamily damped{.form = form, .has_ground_damper = true};
  std::vector<MechanicalParameters> from = starts(damped, data, sampling);
  from.push_back(result.family.unpack(result.fit.theta));
  from.back().b_0_Ns_per_m = 0.1;
  const ResponseFit other = best_fit(damped, from, data, sampling);
  const double widening = std::max(1.0, other.error);
  const bool better = result.fit.cost - other.cost > kChiSquare99 * widening * widening;
  const MechanicalParameters alone = result.family.unpack(result.fit.theta);
  if (better || mode_Hz(alone) < data.frequency_Hz.minCoeff()) {
    result.family = damped;
    result.fit = other;
  }
  result.parameters = result.family.unpack(result.fit.theta);
  result.estimates = estimates(result.family, result.fit);
  return result;
}

}  // namespace teleop
