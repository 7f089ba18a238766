#include "core/identification/probe_motion.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include <fmt/format.h>

#include "core/base/error.hpp"
#include "core/model/dynamics.hpp"

namespace teleop {
namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;
constexpr std::array<double, kJoints> kRange_rad{0.35, 0.25, 0.25};
/// Joints do not turn round at the same time.
constexpr std::array<double, kJoints> kPace{1.0, 0.83, 1.21};

/// Rises and falls at one speed, once a unit of `phase`; begins at 0 and upwards.
double triangle(double phase) {
  const double x = phase - std::floor(phase);
  return x < 0.25 ? 4.0 * x : x < 0.75 ? 2.0 - 4.0 * x : 4.0 * x - 4.0;
}

double triangle_slope(double phase) {
  const double x = phase - std::floor(phase);
  return x < 0.25 || x >= 0.75 ? 4.0 : -4.0;
}

/// Grows from 0 to 1 in the first second.
double growth(double t_s) { return std::min(t_s, 1.0); }

ProbePoint sweep(double t_s, double rate_Hz) {
  ProbePoint point;
  for (std::size_t i = 0; i < kJoints; ++i) {
    const auto axis = static_cast<Eigen::Index>(i);
    const double rate = rate_Hz * kPace.at(i);
    point.q[axis] = kRange_rad.at(i) * triangle(rate * t_s);
    point.qd[axis] = kRange_rad.at(i) * rate * triangle_slope(rate * t_s);
  }
  return point;
}

ProbePoint slow_sweep(double t_s) { return sweep(t_s, 0.15); }

ProbePoint swing(double t_s, double rate_Hz, double size) {
  ProbePoint point;
  for (std::size_t i = 0; i < kJoints; ++i) {
    const auto axis = static_cast<Eigen::Index>(i);
    const double rate = kTurn * rate_Hz * kPace.at(i);
    const double range = size * kRange_rad.at(i) * growth(t_s);
    point.q[axis] = range * std::sin(rate * t_s);
    point.qd[axis] = range * rate * std::cos(rate * t_s);
  }
  return point;
}

ProbePoint fast_sweep(double t_s) { return swing(t_s, 1.5, 1.0); }

/// Lines evenly spread over the decades, with phases that keep the peak low.
ProbePoint multisine(double t_s) {
  constexpr int kLines = 24;
  constexpr double kLow_Hz = 5.0;
  constexpr double kHigh_Hz = 200.0;
  constexpr std::array<double, kJoints> kTorque_Nm{0.030, 0.025, 0.015};  // RMS
  ProbePoint point = swing(t_s, 0.3, 0.5);
  for (std::size_t i = 0; i < kJoints; ++i) {
    double sum = 0.0;
    for (int n = 0; n < kLines; ++n) {
      // The joints' lines lie between each other's.
      const double place = (n + static_cast<double>(i) / kJoints) / kLines;
      const double f = kLow_Hz * std::pow(kHigh_Hz / kLow_Hz, place);
      const double phase = -std::numbers::pi * n * (n - 1) / kLines;
      sum += std::cos(kTurn * f * t_s + phase);
    }
    point.torque[static_cast<Eigen::Index>(i)] =
        growth(t_s) * kTorque_Nm.at(i) * std::sqrt(2.0 / kLines) * sum;
  }
  return point;
}

/// A third of the time at each rate, and in each third half of it under a bias.
ProbePoint triangles(double t_s) {
  constexpr double kPart_s = 4.0;
  constexpr std::array<double, 3> kRate_Hz{0.5, 2.0, 8.0};
  constexpr double kTenCounts = 1.3e-3;  // rad
  constexpr std::array<double, kJoints> kBias_Nm{0.006, 0.005, 0.003};
  const auto part = std::min<std::size_t>(static_cast<std::size_t>(t_s / kPart_s), 2);
  const double rate = kRate_Hz.at(part);
  const bool pushed = t_s - kPart_s * static_cast<double>(part) > kPart_s / 2.0;
  ProbePoint point;
  for (std::size_t i = 0; i < kJoints; ++i) {
    const auto axis = static_cast<Eigen::Index>(i);
    const double own = rate * kPace.at(i);
    point.q[axis] = kTenCounts * triangle(own * t_s);
    point.qd[axis] = kTenCounts * own * triangle_slope(own * t_s);
    if (pushed) point.torque[axis] = kBias_Nm.at(i);
  }
  return point;
}

/// Works for a third of the time, rests for a third, and works in the same way again.
ProbePoint rest_repeat(double t_s) {
  constexpr double kPart_s = 6.0;
  const int part = static_cast<int>(t_s / kPart_s);
  if (part == 1) return {};
  return swing(t_s - kPart_s * part, 2.0, 0.8);
}

/// From posture to posture, each held for a second.
ProbePoint postures(double t_s) {
  constexpr std::array<std::array<double, kJoints>, 6> kPostures{{{0.0, 0.0, 0.0},
                                                                  {0.3, 0.25, -0.15},
                                                                  {-0.3, -0.25, 0.2},
                                                                  {0.2, -0.2, -0.2},
                                                                  {-0.2, 0.25, 0.25},
                                                                  {0.0, 0.0, 0.0}}};
  constexpr double kMove_s = 0.6;
  constexpr double kStay_s = 1.0;
  constexpr double kEach_s = kMove_s + kStay_s;
  const auto last =
      std::min<std::size_t>(static_cast<std::size_t>(t_s / kEach_s) + 1, kPostures.size() - 1);
  const double u = std::min((t_s - kEach_s * static_cast<double>(last - 1)) / kMove_s, 1.0);
  const double way = u * u * u * (10.0 + u * (-15.0 + 6.0 * u));
  const double speed = 30.0 * u * u * (1.0 - u) * (1.0 - u) / kMove_s;
  ProbePoint point;
  for (std::size_t i = 0; i < kJoints; ++i) {
    const auto axis = static_cast<Eigen::Index>(i);
    const double from = kPostures.at(last - 1).at(i);
    const double to = kPostures.at(last).at(i);
    point.q[axis] = from + way * (to - from);
    point.qd[axis] = speed * (to - from);
  }
  return point;
}

ProbePoint hands_off(double t_s) {
  ProbePoint point = swing(t_s, 0.3, 0.6);
  const ProbePoint fast = swing(t_s, 2.2, 0.3);
  point.q += fast.q;
  point.qd += fast.qd;
  return point;
}

constexpr std::array kMotions{
    ProbeMotion{.name = "slow_sweep",
                .text = "a slow sweep to both sides, at one speed",
                .tells = "what acts at rest and in slow motion from what grows with speed",
                .seconds = 14.0,
                .at = slow_sweep},
    ProbeMotion{.name = "fast_sweep",
                .text = "fast swings over the same range",
                .tells = "what grows with speed or acceleration from what does not",
                .seconds = 8.0,
                .at = fast_sweep},
    ProbeMotion{.name = "multisine",
                .text = "small torques of 5 to 200 Hz on a slow swing",
                .tells = "delays, slow amplifiers and elastic transmissions",
                .seconds = 8.0,
                .at = multisine},
    ProbeMotion{.name = "triangles",
                .text = "triangles of ten counts at three rates, with and without a bias torque",
                .tells = "play, presliding and Stribeck friction",
                .seconds = 12.0,
                .stiff = true,
                .at = triangles},
    ProbeMotion{.name = "rest_repeat",
                .text = "hard work, a rest, and the same work again",
                .tells = "what comes and goes with heat from what stays",
                .seconds = 18.0,
                .at = rest_repeat},
    ProbeMotion{.name = "postures",
                .text = "six postures, each held still for a second",
                .tells = "gains from inertia, by the weight of the arm",
                .seconds = 8.0,
                .at = postures},
    ProbeMotion{.name = "hands_off",
                .text = "slow and fast swings with nobody near the arm",
                .tells = "a hand at the tool from springs and damping of the arm",
                .seconds = 8.0,
                .hands_off = true,
                .at = hands_off},
};

JointVector vector_of(const std::array<double, kJoints>& values) {
  return JointVector{values.data()};
}

}  // namespace

std::span<const ProbeMotion> probe_motions() noexcept { return kMotions; }

const ProbeMotion& find_probe_motion(std::string_view name) {
  std::string names;
  for (const ProbeMotion& each : kMotions) {
    if (each.name == name) return each;
    names += fmt::format("{}{}", names.empty() ? "" : ", ", each.name);
  }
  throw ConfigError{fmt::format("no such motion '{}'; allowed: {}", name, names)};
}

ProbeLaw::ProbeLaw(const Config& config, const ArmModel& arm, const ProbeMotion& motion)
    : arm_{arm},
      motion_{motion},
      home_{vector_of(config.home_rad)},
      stiffness_{vector_of(config.stiffness_Nm_per_rad)},
      damping_{vector_of(config.damping_Nms_per_rad)} {
  if (!motion.stiff) return;
  stiffness_ *= config.stiff_factor;
  damping_ *= std::sqrt(config.stiff_factor);
}

JointVector ProbeLaw::step(double t_s, const JointVector& q, const JointVector& qd) const noexcept {
  const ProbePoint wanted = motion_.at(t_s);
  return gravity_torque(arm_, q) + stiffness_.cwiseProduct(home_ + wanted.q - q) +
         damping_.cwiseProduct(wanted.qd - qd) + wanted.torque;
}

JointVector ProbeLaw::start() const noexcept { return home_ + motion_.at(0.0).q; }

}  // namespace teleop
