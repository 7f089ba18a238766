#include <cmath>
#include <cstddef>
#include <limits>

#include <Eigen/Eigenvalues>
#include <gtest/gtest.h>
#include <unsupported/Eigen/MatrixFunctions>

#include "core/identification/mechanical_form.hpp"
#include "core/identification/printed_responses.hpp"
#include "core/math/random.hpp"
#include "tests/identification/plants.hpp"

namespace teleop {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

TEST(Passivity, OfThePrintedResponsesIsLostWhereTheirPowerComesOut) {
  const auto [x, y, z] = printed_responses();

  const Passivity of_x = passivity(x);
  EXPECT_FALSE(of_x.passive);
  ASSERT_EQ(of_x.active_Hz.size(), 1U);
  EXPECT_EQ(of_x.active_Hz[0].low, 0.0);
  EXPECT_NEAR(of_x.active_Hz[0].high, 46.7, 0.05);

  const Passivity of_y = passivity(y);
  EXPECT_FALSE(of_y.passive);
  ASSERT_EQ(of_y.active_Hz.size(), 2U);
  EXPECT_EQ(of_y.active_Hz[0].low, 0.0);
  EXPECT_NEAR(of_y.active_Hz[0].high, 40.7, 0.05);
  EXPECT_NEAR(of_y.active_Hz[1].low, 72.2, 0.05);
  EXPECT_EQ(of_y.active_Hz[1].high, kInfinity);

  EXPECT_TRUE(passivity(z).passive);
}

TEST(Passivity, AgreesWithASweepOverFrequencies) {
  for (const TransferFunction& P : printed_responses()) {
    const Passivity result = passivity(P);
    for (int i = 0; i < 4000; ++i) {
      const double f = 0.5 * std::pow(1e4, i / 4000.0);
      const bool active = (std::complex<double>{0.0, f} * response(P, f)).real() < 0.0;
      bool listed = false;
      bool near_edge = false;
      for (const Range& range : result.active_Hz) {
        listed = listed || (f > range.low && f < range.high);
        near_edge = near_edge || std::abs(f / range.high - 1.0) < 1e-3 ||
                    std::abs(f / std::max(range.low, 1e-9) - 1.0) < 1e-3;
      }
      EXPECT_TRUE(near_edge || listed == active) << f << " Hz";
    }
  }
}

TEST(Passivity, HoldsForEveryMechanismOfBothForms) {
  Random random{3};
  for (int i = 0; i < 200; ++i) {
    for (const MechanicalForm form : {MechanicalForm::a, MechanicalForm::b}) {
      const Passivity result =
          passivity(transfer_function(form, testing::random_mechanism(form, random)));
      EXPECT_TRUE(result.passive) << i << (result.active_Hz.empty() ? "" : " active");
    }
  }
}

/// Whether the wall u = −K y, sampled at 1 kHz with a zero-order hold, is stable on P (mm/N).
bool wall_is_stable(const TransferFunction& P, double K_N_per_mm) {
  // Slowed down by omega_0, so that the companion form is well conditioned.
  constexpr double kOmega0 = 300.0;
  TransferFunction slow = P;
  for (Eigen::VectorXd* polynomial : {&slow.numerator, &slow.denominator}) {
    const Eigen::Index n = polynomial->size() - 1;
    for (Eigen::Index i = 0; i <= n; ++i) {
      (*polynomial)(i) *= std::pow(kOmega0, static_cast<double>(n - i));
    }
  }
  slow.denominator *= kOmega0 * kOmega0;
  const LinearModel model = realisation(slow);
  const Eigen::Index n = model.A.rows();
  Eigen::MatrixXd held = Eigen::MatrixXd::Zero(n + 1, n + 1);
  held.topLeftCorner(n, n) = model.A;
  held.topRightCorner(n, 1) = model.B;
  const Eigen::MatrixXd E = (held * (1e-3 * kOmega0)).exp();
  // States: x and the held force, which the feed-through shows until the next write.
  Eigen::MatrixXd loop = Eigen::MatrixXd::Zero(n + 1, n + 1);
  Eigen::RowVectorXd y{n + 1};
  y << model.C, model.D;
  loop.topRows(n).leftCols(n) = E.topLeftCorner(n, n);
  loop.topRows(n) -= K_N_per_mm * E.topRightCorner(n, 1) * y;
  loop.row(n) = -K_N_per_mm * y;
  return loop.eigenvalues().cwiseAbs().maxCoeff() < 1.0;
}

TEST(PrintedResponses, AllowNoWallOnXAndYAndOneOnZ) {
  const auto [x, y, z] = printed_responses();
  bool on_z = false;
  for (int i = 0; i <= 120; ++i) {
    const double K = 1e-3 * std::pow(10.0, i / 20.0);
    EXPECT_FALSE(wall_is_stable(x, K)) << K << " N/mm";
    EXPECT_FALSE(wall_is_stable(y, K)) << K << " N/mm";
    on_z = on_z || wall_is_stable(z, K);
  }
  EXPECT_TRUE(on_z);
}

TEST(TransferFunction, RealisationHasTheSameResponse) {
  for (const TransferFunction& P : printed_responses()) {
    const Eigen::VectorXd f = testing::lines(1.0, 400.0, 50);
    const Eigen::VectorXcd values = continuous_response(realisation(P), f);
    for (Eigen::Index i = 0; i < f.size(); ++i) {
      EXPECT_NEAR(std::abs(values(i) / response(P, f(i)) - 1.0), 0.0, 1e-9);
    }
  }
}

TEST(TransferFunction, OfAFormIsTheResponseOfItsMechanism) {
  Random random{8};
  for (const MechanicalForm form : {MechanicalForm::a, MechanicalForm::b}) {
    const MechanicalFamily family{.form = form};
    const MechanicalParameters p = testing::random_mechanism(form, random);
    const TransferFunction P = transfer_function(form, p);
    const Eigen::VectorXd f = testing::lines(1.0, 400.0, 50);
    const Eigen::VectorXcd values = continuous_response(family(family.pack(p)).model, f);
    for (Eigen::Index i = 0; i < f.size(); ++i) {
      EXPECT_NEAR(std::abs(values(i) / response(P, f(i)) - 1.0), 0.0, 1e-9);
    }
  }
}

}  // namespace
}  // namespace teleop
