#include "core/diagnosis/base_prior.hpp"

#include <vector>

#include <Eigen/Eigenvalues>

namespace teleop {
namespace {

using Vector = BasePrior::Vector;

Vector vector_of(const ArmModel::Lumped& k) {
  return (Vector{} << k.K, k.S0, k.S2, k.S3, k.M22, k.M33, k.N2, k.N3).finished();
}

ArmModel::Lumped lumped_of(const Vector& v) {
  return {.K = v[0],
          .S0 = v[1],
          .S2 = v[2],
          .S3 = v[3],
          .M22 = v[4],
          .M33 = v[5],
          .N2 = v[6],
          .N3 = v[7]};
}

/// Every mass and inertia.
std::vector<double*> constants(ArmParameters& arm) {
  std::vector<double*> all{&arm.ma_kg, &arm.mc_kg, &arm.mbe_kg, &arm.mdf_kg, &arm.Ibase_kg_m2};
  for (auto* inertia : {&arm.Ia_kg_m2, &arm.Ic_kg_m2, &arm.Ibe_kg_m2, &arm.Idf_kg_m2}) {
    for (double& each : *inertia) {
      all.push_back(&each);
    }
  }
  return all;
}

}  // namespace

BasePrior::BasePrior(const ArmModel& arm, double tolerance)
    : nominal_{arm}, spread_{decltype(spread_)::Zero()} {
  constexpr double kStep = 1e-3;  // the lumped constants are linear in masses and inertias
  const Vector centre = vector_of(arm.lumped());
  ArmParameters parameters = arm.parameters();
  decltype(spread_) covariance = decltype(spread_)::Zero();
  for (double* constant : constants(parameters)) {
    const double before = *constant;
    *constant = before * (1.0 + kStep);
    const Vector slope = (vector_of(ArmModel{parameters}.lumped()) - centre) / kStep * tolerance;
    covariance += slope * slope.transpose();
    *constant = before;
  }
  // Constants of very different sizes: in units of their own.
  const Vector unit = covariance.diagonal().cwiseSqrt().cwiseMax(1e-15);
  const Eigen::SelfAdjointEigenSolver<decltype(spread_)> solver{
      unit.cwiseInverse().asDiagonal() * covariance * unit.cwiseInverse().asDiagonal()};
  spread_ = unit.asDiagonal() * solver.eigenvectors() *
            solver.eigenvalues().cwiseMax(0.0).cwiseSqrt().asDiagonal();
}

ArmModel BasePrior::arm(const Vector& z) const {
  const Vector shifted = vector_of(nominal_.lumped()) + spread_ * z;
  return nominal_.with(lumped_of(shifted));
}

}  // namespace teleop
