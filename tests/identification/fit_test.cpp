#include <array>
#include <cmath>
#include <complex>
#include <cstdint>
#include <vector>

#include <gtest/gtest.h>

#include "core/identification/mechanical_form.hpp"
#include "core/identification/polynomial_fit.hpp"
#include "core/math/random.hpp"
#include "tests/identification/plants.hpp"

namespace teleop {
namespace {

using testing::noisy_response;
using testing::random_mechanism;

constexpr std::array kForms{MechanicalForm::a, MechanicalForm::b};

/// x_k of the mechanism by fine steps of the classical Runge–Kutta method under a held force.
std::vector<double> simulated(const LinearModel& model,
                              const Sampling& sampling,
                              const std::vector<double>& force) {
  constexpr int kSteps = 200;
  const double h = sampling.period_s / kSteps;
  Eigen::VectorXd x = Eigen::VectorXd::Zero(model.A.rows());
  double f = 0.0;
  std::vector<double> y;
  for (std::size_t k = 0; k < force.size(); ++k) {
    const double u = k == 0 ? 0.0 : force[k - 1];
    for (int i = 0; i < kSteps && k > 0; ++i) {
      const auto slope = [&](const Eigen::VectorXd& state, double lagged) {
        return (model.A * state + model.B * lagged).eval();
      };
      const double half = u + (f - u) * std::exp(-0.5 * h / sampling.amplifier_lag_s);
      const double full = u + (f - u) * std::exp(-h / sampling.amplifier_lag_s);
      const Eigen::VectorXd k1 = slope(x, f);
      const Eigen::VectorXd k2 = slope(x + 0.5 * h * k1, half);
      const Eigen::VectorXd k3 = slope(x + 0.5 * h * k2, half);
      const Eigen::VectorXd k4 = slope(x + h * k3, full);
      x += h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4);
      f = full;
    }
    y.push_back(model.C.dot(x) + model.D * f);
  }
  return y;
}

TEST(SampledResponse, IsWhatAFineIntegrationShows) {
  // A force pulse pair without momentum and without net displacement, so that the sums converge.
  const Sampling sampling{.period_s = 1e-3, .amplifier_lag_s = 0.4e-3, .delay_samples = 0};
  const MechanicalFamily family{.form = MechanicalForm::b};
  const MechanicalParameters p{
      .m1_kg = 0.03, .m2_kg = 0.02, .k_N_per_m = 3000.0, .b_Ns_per_m = 4.0, .k_t_N_per_m = 5000.0};
  std::vector<double> force(400, 0.0);
  force[0] = 1.0;
  force[1] = -2.0;
  force[2] = 1.0;
  const Linearised system = family(family.pack(p));
  const std::vector<double> y = simulated(system.model, sampling, force);

  const Eigen::VectorXd f = testing::lines(20.0, 480.0, 24);
  const ComplexResponse response = sampled_response(system, sampling, f);
  for (Eigen::Index i = 0; i < f.size(); ++i) {
    std::complex<double> Y = 0.0;
    std::complex<double> U = 0.0;
    for (std::size_t k = 0; k < y.size(); ++k) {
      const auto turn =
          std::polar(1.0, -2.0 * 3.14159265358979323846 * f(i) * 1e-3 * static_cast<double>(k));
      Y += y[k] * turn;
      U += force[k] * turn;
    }
    EXPECT_NEAR(std::abs(Y / U - response.value(i)), 0.0, 1e-6 * std::abs(response.value(i)))
        << f(i) << " Hz";
  }
}

TEST(SampledResponse, DelaysByWholeSamples) {
  const MechanicalFamily family{.form = MechanicalForm::b};
  Random random{4};
  const Linearised system = family(family.pack(random_mechanism(MechanicalForm::b, random)));
  const Eigen::VectorXd f = testing::lines(20.0, 480.0, 24);
  const ComplexResponse now = sampled_response(system, {.delay_samples = 0}, f);
  const ComplexResponse late = sampled_response(system, {.delay_samples = 2}, f);
  for (Eigen::Index i = 0; i < f.size(); ++i) {
    const auto turn = std::polar(1.0, -2.0 * 3.14159265358979323846 * f(i) * 2e-3);
    EXPECT_NEAR(std::abs(late.value(i) - now.value(i) * turn), 0.0, 1e-12 * std::abs(now.value(i)));
  }
}

/// Largest departure of the stated derivatives from central differences, over the largest
/// derivative.
double derivative_error(const ModelFamily& family,
                        const Eigen::VectorXd& theta,
                        const Sampling& sampling) {
  constexpr double kStep = 1e-6;
  const Eigen::VectorXd f = testing::lines(5.0, 450.0, 15);
  const ComplexResponse response = sampled_response(family(theta), sampling, f);
  double worst = 0.0;
  for (Eigen::Index k = 0; k < theta.size(); ++k) {
    Eigen::VectorXd up = theta;
    Eigen::VectorXd down = theta;
    up(k) += kStep;
    down(k) -= kStep;
    const Eigen::VectorXcd difference = (sampled_response(family(up), sampling, f).value -
                                         sampled_response(family(down), sampling, f).value) /
                                        (2.0 * kStep);
    const Eigen::VectorXd error = (difference - response.derivative.col(k)).cwiseAbs();
    worst = std::max(worst, error.cwiseQuotient(response.value.cwiseAbs()).maxCoeff());
  }
  return worst;
}

TEST(SampledResponse, DerivativesOfTheFormsAreThoseOfCentralDifferences) {
  Random random{7};
  for (const MechanicalForm form : kForms) {
    for (const bool ground : {false, true}) {
      for (const double lag_s : {0.0, 3e-4}) {
        const MechanicalFamily family{.form = form, .has_ground_damper = ground};
        MechanicalParameters p = random_mechanism(form, random);
        p.b_0_Ns_per_m = 0.5;
        const Sampling sampling{.period_s = 1e-3, .amplifier_lag_s = lag_s, .delay_samples = 1};
        EXPECT_LT(derivative_error(family, family.pack(p), sampling), 1e-6);
      }
    }
  }
}

TEST(FitMechanical, FindsPlantedFormsFromNoisyResponses) {
  Random random{11};
  for (int i = 0; i < 20; ++i) {
    const MechanicalForm form = kForms.at(static_cast<std::size_t>(i % 2));
    const MechanicalFamily family{.form = form};
    const MechanicalParameters p = random_mechanism(form, random);
    const Sampling sampling{.period_s = 1e-3, .amplifier_lag_s = 0.0, .delay_samples = i % 3};
    const MeasuredResponse data = noisy_response(family, p, sampling, 0.01, random);

    const MechanicalFit fit = fit_mechanical(form, data, sampling);
    const Eigen::VectorXd truth = family.pack(p);
    for (Eigen::Index k = 0; k < truth.size(); ++k) {
      const Estimate& estimate = fit.estimates.at(static_cast<std::size_t>(k));
      EXPECT_NEAR(estimate.value / std::exp(truth(k)), 1.0,
                  5.0 * estimate.deviation / estimate.value)
          << estimate.name << " of plant " << i;
    }
    EXPECT_NEAR(fit.fit.error, 1.0, 0.25) << i;
  }
}

TEST(FitMechanical, IntervalsHoldTheTruthNineTimesOfTen) {
  Random random{23};
  int inside = 0;
  int all = 0;
  for (int i = 0; i < 60; ++i) {
    const MechanicalForm form = kForms.at(static_cast<std::size_t>(i % 2));
    const MechanicalFamily family{.form = form};
    const MechanicalParameters p = random_mechanism(form, random);
    const Sampling sampling{.period_s = 1e-4};
    const MechanicalFit fit =
        fit_mechanical(form, noisy_response(family, p, sampling, 0.02, random), sampling);
    const Eigen::VectorXd truth = family.pack(p).array().exp();
    for (Eigen::Index k = 0; k < truth.size(); ++k, ++all) {
      const Estimate& estimate = fit.estimates.at(static_cast<std::size_t>(k));
      inside += static_cast<int>(estimate.low <= truth(k) && truth(k) <= estimate.high);
    }
  }
  // Three standard deviations of so small a sample; the campaign has the sharp bounds.
  EXPECT_GE(inside, 0.84 * all);
  EXPECT_LE(inside, 0.96 * all);
}

TEST(FitMechanical, KeepsADamperToGroundOnlyWhereThereIsOne) {
  Random random{31};
  const Sampling sampling{.period_s = 1e-3};
  MechanicalParameters p = random_mechanism(MechanicalForm::a, random);
  const MeasuredResponse without =
      noisy_response({.form = MechanicalForm::a}, p, sampling, 0.01, random);
  EXPECT_FALSE(fit_mechanical(MechanicalForm::a, without, sampling).family.has_ground_damper);

  p.b_0_Ns_per_m = 1.0;
  const MechanicalFamily damped{.form = MechanicalForm::a, .has_ground_damper = true};
  const MechanicalFit fit = fit_mechanical(
      MechanicalForm::a, noisy_response(damped, p, sampling, 0.01, random), sampling);
  ASSERT_TRUE(fit.family.has_ground_damper);
  EXPECT_NEAR(fit.parameters.b_0_Ns_per_m, 1.0, 0.1);
}

TEST(FitPolynomial, FindsThePolynomialsOfAMechanismAndDerivativesAreExact) {
  Random random{5};
  for (int i = 0; i < 10; ++i) {
    const MechanicalForm form = kForms.at(static_cast<std::size_t>(i % 2));
    const MechanicalParameters p = random_mechanism(form, random);
    const Sampling sampling{.period_s = 1e-4};
    const MeasuredResponse data = noisy_response({.form = form}, p, sampling, 1e-3, random);
    const PolynomialFit fit = fit_polynomial(
        {.numerator = form == MechanicalForm::a ? 2 : 4, .denominator = 2}, data, sampling);
    TransferFunction truth = transfer_function(form, p);
    truth.denominator /= truth.numerator(0);
    truth.numerator /= truth.numerator(0);
    for (Eigen::Index k = 1; k < truth.numerator.size(); ++k) {
      EXPECT_NEAR(fit.P.numerator(k), truth.numerator(k), 5.0 * fit.deviation.numerator(k)) << i;
    }
    for (Eigen::Index k = 0; k < 3; ++k) {
      EXPECT_NEAR(fit.P.denominator(k), truth.denominator(k), 5.0 * fit.deviation.denominator(k))
          << i;
    }
    EXPECT_NEAR(fit.fit.error, 1.0, 0.25) << i;
  }
}

}  // namespace
}  // namespace teleop
