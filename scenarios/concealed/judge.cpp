#include "scenarios/concealed/judge.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Core>

#include "scenarios/concealed/plant.hpp"

namespace teleop::concealed {
namespace {

constexpr std::size_t kSettled = 200;  // rows
constexpr int kIterations = 4000;

JointVector readings(const Run& run, std::size_t row, const JointVector& count) {
  const auto& counts = run.counts[row];
  return JointVector{static_cast<double>(counts[0]), static_cast<double>(counts[1]),
                     static_cast<double>(counts[2])}
      .cwiseProduct(count);
}

/// Diagonal of the mass matrix at the mean posture.
JointVector mean_inertia(const Device& device, const Run& run) {
  const JointVector count = count_rad(device.nominal);
  JointVector q = JointVector::Zero();
  for (std::size_t k = 0; k < run.counts.size(); ++k) {
    q += readings(run, k, count);
  }
  q /= static_cast<double>(run.counts.size());
  const ArmModel::Lumped& body = device.arm.lumped();
  return {body.S0 + body.S2 * std::cos(2.0 * q[1]) - body.S3 * std::cos(2.0 * q[2]) +
              body.K * std::cos(q[1]) * std::sin(q[2]),
          body.M22, body.M33};
}

std::array<TetherGain, kJoints> gains(const Device& device, const JointVector& inertia) {
  const JointVector count = count_rad(device.nominal);
  const Disturbance& noise = device.disturbance;
  std::array<TetherGain, kJoints> result{};
  for (std::size_t i = 0; i < kJoints; ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    const double counts = noise.encoder_noise_counts;
    result.at(i) = tether_gain(inertia[k],
                               {.white_Nm = noise.white_Nm[k],
                                .coloured_Nm = noise.coloured_Nm[k],
                                .coloured_time_s = noise.coloured_time_s[k],
                                .reading_rad = count[k] * std::sqrt(1.0 / 12.0 + counts * counts)},
                               kStatedPeriod);
  }
  return result;
}

}  // namespace

TetherGain tether_gain(double inertia, const AxisNoise& noise, double period) {
  const double phi = std::exp(-period / noise.coloured_time_s);
  const double push = period / inertia;
  // Counts of angle and milliseconds keep the matrices well scaled.
  const double unit = noise.reading_rad;
  const double forward = period * push / (2.0 * unit);
  Eigen::Matrix3d F;
  F << 1.0, 1.0, forward,              //
      0.0, 1.0, period * push / unit,  //
      0.0, 0.0, phi;
  const Eigen::Vector3d white =
      noise.white_Nm * Eigen::Vector3d{forward, period * push / unit, 0.0};
  Eigen::Matrix3d Q = white * white.transpose();
  Q(2, 2) += noise.coloured_Nm * noise.coloured_Nm * (1.0 - phi * phi);
  Eigen::Matrix3d P = Eigen::Vector3d{1.0, 1.0, 0.0}.asDiagonal();
  P(2, 2) = noise.coloured_Nm * noise.coloured_Nm;
  Eigen::Vector3d K = Eigen::Vector3d::Zero();
  for (int k = 0; k < kIterations; ++k) {
    K = P.col(0) / (P(0, 0) + 1.0);
    const Eigen::Matrix3d updated = P - K * P.row(0);
    P = F * updated * F.transpose() + Q;
    P = (P + P.transpose().eval()) / 2.0;
  }
  return {.q = K[0], .v = K[1] / period, .d = K[2] / unit, .forgotten = phi};
}

JointVector innovations(const Device& device,
                        const JudgedRun& judged,
                        bool true_model,
                        int substeps) {
  const Run& run = *judged.run;
  const RunPlan& plan = device.runs[judged.index];
  const std::array<TetherGain, kJoints> whole = gains(device, mean_inertia(device, run));
  const PlantLaw law = true_model ? law_of(device, judged.index) : plant_law(device.arm, {}, 0);
  JointVector rotors = JointVector::Ones();
  for (std::size_t i = 0; i < kJoints; ++i) {
    const TransmissionLaw& transmission = law.axes.at(i).transmission;
    if (transmission.play) rotors[static_cast<Eigen::Index>(i)] = transmission.rotor;
  }
  const std::array<TetherGain, kJoints> loose = gains(device, rotors);
  const JointVector count = count_rad(device.nominal);
  const JointVector start = true_model ? plan.q : readings(run, 0, count);
  Plant plant{law, start, plan.v, substeps};
  JointVector d = JointVector::Zero();
  JointVector squares = JointVector::Zero();
  for (std::size_t k = 0; k < run.counts.size(); ++k) {
    const double late = true_model && !run.late.empty() ? run.late[k] : 0.0;
    JointVector e = readings(run, k, count) - plant.reading(late);
    JointVector by_q;
    JointVector by_v;
    for (std::size_t i = 0; i < kJoints; ++i) {
      const auto axis = static_cast<Eigen::Index>(i);
      e[axis] -= count[axis] * slipped_counts(law.axes.at(i).reading, plant.time());
      const TetherGain& g = plant.open(i) ? loose.at(i) : whole.at(i);
      by_q[axis] = g.q * e[axis];
      by_v[axis] = g.v * e[axis];
      d[axis] += g.d * e[axis];
    }
    plant.correct(by_q, by_v);
    if (k >= kSettled) squares += e.cwiseProduct(e);
    plant.command(true_model ? run.applied[k] : run.logged[k]);
    plant.advance_half(d);
    plant.advance_half(d);
    for (std::size_t i = 0; i < kJoints; ++i) {
      d[static_cast<Eigen::Index>(i)] *= whole.at(i).forgotten;
    }
  }
  return (squares / static_cast<double>(run.counts.size() - kSettled)).cwiseSqrt();
}

double detectability(const Device& device, std::span<const JudgedRun> runs, int substeps) {
  if (device.effects.empty()) return 0.0;
  JointVector with = JointVector::Zero();
  JointVector without = JointVector::Zero();
  for (const JudgedRun& run : runs) {
    with += innovations(device, run, true, substeps).cwiseAbs2();
    without += innovations(device, run, false, substeps).cwiseAbs2();
  }
  // A tether that does not hold says nothing.
  if (!with.allFinite() || !without.allFinite()) return HUGE_VAL;
  return without.cwiseQuotient(with).cwiseSqrt().maxCoeff() - 1.0;
}

}  // namespace teleop::concealed
