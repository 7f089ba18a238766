#include "scenarios/concealed/device_draw.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

namespace teleop::concealed {
namespace {

using std::numbers::pi;
constexpr double kTolerance = 0.005;
const JointVector noise_share{1.0, 0.75, 0.45};  // of the axes: the lighter, the quieter

double log_uniform(Random& random, double low, double high) {
  return low * std::pow(high / low, random.uniform());
}

ArmModel off_nominal(const ArmModel& nominal, bool edge, Random& random) {
  ArmParameters arm = nominal.parameters();
  const auto shift = [&](double& value) {
    const double x = random.uniform(-1.0, 1.0);
    value *= 1.0 + kTolerance * (edge ? std::copysign(1.0, x) : x);
  };
  for (double* mass : {&arm.ma_kg, &arm.mc_kg, &arm.mbe_kg, &arm.mdf_kg, &arm.Ibase_kg_m2}) {
    shift(*mass);
  }
  for (auto* inertia : {&arm.Ia_kg_m2, &arm.Ic_kg_m2, &arm.Ibe_kg_m2, &arm.Idf_kg_m2}) {
    for (double& each : *inertia) {
      shift(each);
    }
  }
  return ArmModel{arm};
}

Disturbance draw_disturbance(const DeviceWish& wish, Random& random) {
  Disturbance result;
  for (Eigen::Index i = 0; i < noise_share.size(); ++i) {
    result.white_Nm[i] = wish.white * noise_share[i] * log_uniform(random, 2e-4, 8e-4);
    result.coloured_Nm[i] = wish.coloured * noise_share[i] * log_uniform(random, 3e-4, 1.1e-3);
    result.coloured_time_s[i] = random.uniform(0.01, 0.06);
  }
  if (wish.narrow_Nm > 0.0) {
    const auto axis = std::min<Eigen::Index>(static_cast<Eigen::Index>(3.0 * random.uniform()), 2);
    result.narrow_Nm[axis] = wish.narrow_Nm * noise_share[axis];
    result.narrow_Hz = random.uniform(3.0, 14.0);
  }
  const bool noisy = random.uniform() < 0.3;
  const double counts = random.uniform(0.15, 1.0);
  result.encoder_noise_counts = wish.encoder_noise ? 0.7 + 0.3 * counts : noisy ? counts : 0.0;
  return result;
}

template <class T>
void shuffle(std::vector<T>& items, Random& random) {
  for (std::size_t i = items.size(); i > 1; --i) {
    std::swap(items[i - 1], items[static_cast<std::size_t>(random.bits() % i)]);
  }
}

/// Four sorts that a careful experimenter would not leave out, and two more.
std::vector<Movement> draw_movements(Random& random) {
  std::vector others{Movement::circles, Movement::pulses, Movement::triangles, Movement::multisine,
                     Movement::chirp,   Movement::hand,   Movement::reaching};
  shuffle(others, random);
  std::vector movements{random.uniform() < 0.5 ? Movement::multisine : Movement::chirp,
                        Movement::reaching,
                        Movement::sweeps,
                        Movement::hand,
                        others[0],
                        others[1]};
  shuffle(movements, random);
  return movements;
}

JointVector middle_inertia(const ArmModel& arm) {
  const ArmModel::Lumped& body = arm.lumped();
  const JointVector q = middle_posture();
  return {body.S0 + body.S2 * std::cos(2.0 * q[1]) - body.S3 * std::cos(2.0 * q[2]) +
              body.K * std::cos(q[1]) * std::sin(q[2]),
          body.M22, body.M33};
}

AxisController draw_controller(double inertia, bool soft, double gain, Random& random) {
  const double omega =
      2.0 * pi * gain * (soft ? random.uniform(1.1, 2.4) : random.uniform(1.8, 5.0));
  const double damping_ratio = random.uniform(0.5, 1.1);
  return {.stiffness = inertia * omega * omega,
          .damping = 2.0 * damping_ratio * inertia * omega,
          .bandwidth_Hz = random.uniform(35.0, 140.0),
          .inertia = random.uniform() < 0.5 ? 0.0 : inertia * random.uniform(0.5, 1.05)};
}

}  // namespace

Device draw_device(const ArmModel& nominal, const DeviceWish& wish, Random& random) {
  Device device{.arm = off_nominal(nominal, wish.inertia_edge, random),
                .nominal = nominal,
                .disturbance = draw_disturbance(wish, random),
                .substeps = wish.substeps};
  const std::vector<Movement> drawn = draw_movements(random);
  const std::vector<Movement>& movements = wish.movements.empty() ? drawn : wish.movements;
  const JointVector inertia = middle_inertia(nominal);
  for (std::size_t k = 0; k < kRuns; ++k) {
    RunPlan& plan = device.runs.at(k);
    const Movement movement = movements[k % movements.size()];
    plan.excitation =
        draw_excitation({.movement = movement, .size = wish.motion, .inertia = inertia}, random);
    const bool soft = movement == Movement::multisine || movement == Movement::chirp ||
                      movement == Movement::pulses;
    for (std::size_t i = 0; i < kJoints; ++i) {
      const auto axis = static_cast<Eigen::Index>(i);
      plan.control.at(i) = draw_controller(inertia[axis], soft, wish.loop_gain, random);
      plan.q[axis] = plan.excitation.path.front()[axis] + 0.004 * random.normal();
      plan.v[axis] = plan.excitation.rate.front()[axis] + 0.12 * random.normal();
    }
    plan.seed = random.bits();
  }
  return device;
}

}  // namespace teleop::concealed
