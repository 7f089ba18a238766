#include "core/diagnosis/probes.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

namespace teleop {
namespace {

struct Probe {
  const char* quantity;
  double (*torque)(const ProbeRow&);
};

constexpr std::array kProbes{
    Probe{"constant",
          [](const ProbeRow&) {
            return 1.0;
          }},
    Probe{"angle",
          [](const ProbeRow& r) {
            return r.q;
          }},
    Probe{"angle squared",
          [](const ProbeRow& r) {
            return r.q * r.q;
          }},
    Probe{"angle cubed",
          [](const ProbeRow& r) {
            return r.q * r.q * r.q;
          }},
    Probe{"speed",
          [](const ProbeRow& r) {
            return r.v;
          }},
    Probe{"size of speed",
          [](const ProbeRow& r) {
            return std::abs(r.v);
          }},
    Probe{"speed squared, signed",
          [](const ProbeRow& r) {
            return r.v * std::abs(r.v);
          }},
    Probe{"speed cubed",
          [](const ProbeRow& r) {
            return r.v * r.v * r.v;
          }},
    Probe{"direction",
          [](const ProbeRow& r) {
            return r.sign;
          }},
    Probe{"direction in forward motion",
          [](const ProbeRow& r) {
            return std::max(r.sign, 0.0);
          }},
    Probe{"direction in slow motion",
          [](const ProbeRow& r) {
            return r.sign * std::exp(-r.v * r.v * 9.0);
          }},
    Probe{"direction × angle",
          [](const ProbeRow& r) {
            return r.sign * r.q;
          }},
    Probe{"direction × angle squared",
          [](const ProbeRow& r) {
            return r.sign * r.q * r.q;
          }},
    Probe{"direction × time",
          [](const ProbeRow& r) {
            return r.sign * r.t;
          }},
    Probe{"speed × angle",
          [](const ProbeRow& r) {
            return r.v * r.q;
          }},
    Probe{"speed × time",
          [](const ProbeRow& r) {
            return r.v * r.t;
          }},
    Probe{"command",
          [](const ProbeRow& r) {
            return r.u;
          }},
    Probe{"size of command",
          [](const ProbeRow& r) {
            return std::abs(r.u);
          }},
    Probe{"command squared, signed",
          [](const ProbeRow& r) {
            return r.u * std::abs(r.u);
          }},
    Probe{"command cubed",
          [](const ProbeRow& r) {
            return r.u * r.u * r.u;
          }},
    Probe{"command × time",
          [](const ProbeRow& r) {
            return r.u * r.t;
          }},
    Probe{"command × angle",
          [](const ProbeRow& r) {
            return r.u * r.q;
          }},
    Probe{"command × size of speed",
          [](const ProbeRow& r) {
            return r.u * std::abs(r.v);
          }},
    Probe{"command × size of its rate",
          [](const ProbeRow& r) {
            return r.u * std::abs(r.u_rate);
          }},
    Probe{"rate of command",
          [](const ProbeRow& r) {
            return r.u_rate;
          }},
    Probe{"direction × size of command",
          [](const ProbeRow& r) {
            return r.sign * std::abs(r.u);
          }},
    Probe{"time",
          [](const ProbeRow& r) {
            return r.t;
          }},
    Probe{"angle × time",
          [](const ProbeRow& r) {
            return r.q * r.t;
          }},
    Probe{"the next axis's angle",
          [](const ProbeRow& r) {
            return r.q_other;
          }},
    Probe{"the next axis's angle squared",
          [](const ProbeRow& r) {
            return r.q_other * r.q_other;
          }},
    Probe{"the next axis's angle × angle",
          [](const ProbeRow& r) {
            return r.q_other * r.q;
          }},
    Probe{"the next axis's speed",
          [](const ProbeRow& r) {
            return r.v_other;
          }},
    Probe{"the next axis's direction",
          [](const ProbeRow& r) {
            return r.sign_other;
          }},
    Probe{"the next axis's command",
          [](const ProbeRow& r) {
            return r.u_other;
          }},
    Probe{"direction × the next axis's angle",
          [](const ProbeRow& r) {
            return r.sign * r.q_other;
          }},
};

/// The range of an axis in so many places, each of which is a quantity by itself and together with
/// the direction.
constexpr std::size_t kPlaces = 10;
constexpr std::size_t kQuantities = kProbes.size() + 2 * kPlaces;

/// 1 at a place, falling off to its neighbours.
double nearness(std::size_t place, double q) {
  const double middle = (2.0 * static_cast<double>(place) + 1.0) / kPlaces - 1.0;
  const double x = (q - middle) * 0.6 * kPlaces;
  return std::exp(-x * x);
}

}  // namespace

std::size_t probe_count() noexcept { return kQuantities; }

double probe_torque(std::size_t quantity, const ProbeRow& row) {
  if (quantity < kProbes.size()) return kProbes[quantity].torque(row);
  const std::size_t place = quantity - kProbes.size();
  if (place < kPlaces) return nearness(place, row.q);
  return row.sign * nearness(place - kPlaces, row.q);
}

std::string probe_name(std::size_t quantity) {
  if (quantity < kProbes.size()) return kProbes[quantity].quantity;
  const std::size_t place = quantity - kProbes.size();
  if (place < kPlaces) return fmt::format("angle near place {} of {}", place + 1, kPlaces);
  return fmt::format("direction near place {} of {}", place - kPlaces + 1, kPlaces);
}

ProbeScales probe_scales(const DiagnosisCase& data,
                         const std::vector<std::vector<PredictedState>>& states) {
  JointVector low = JointVector::Constant(1e9);
  JointVector high = JointVector::Constant(-1e9);
  JointVector speed = JointVector::Zero();
  JointVector torque = JointVector::Zero();
  JointVector rate = JointVector::Zero();
  double rows = 0.0;
  for (std::size_t run = 0; run < states.size(); ++run) {
    const Recording& recording = data.runs[run];
    for (std::size_t k = 1; k < states[run].size(); ++k) {
      low = low.cwiseMin(states[run][k].q);
      high = high.cwiseMax(states[run][k].q);
      speed += states[run][k].qd.cwiseAbs2();
      torque += recording.tau[k].cwiseAbs2();
      rate += (recording.tau[k] - recording.tau[k - 1]).cwiseAbs2();
      rows += 1.0;
    }
  }
  const double tiny = 1e-12;
  return {.middle = (low + high) / 2.0,
          .half_range = ((high - low) / 2.0).cwiseMax(tiny),
          .speed = (speed / rows).cwiseSqrt().cwiseMax(tiny),
          .torque = (torque / rows).cwiseSqrt().cwiseMax(tiny),
          .torque_rate = (rate / rows).cwiseSqrt().cwiseMax(tiny)};
}

ProbeRow probe_row(const Recording& run,
                   const std::vector<PredictedState>& states,
                   std::size_t k,
                   Eigen::Index i,
                   const ProbeScales& s) {
  constexpr double kSpeedNoise = 0.02;  // rad/s, of the tethered simulation, about
  const Eigen::Index o = (i + 1) % 3;
  const PredictedState& at = states[k];
  const double rate = k > 0 ? run.tau[k][i] - run.tau[k - 1][i] : 0.0;
  return {.q = (at.q[i] - s.middle[i]) / s.half_range[i],
          .v = at.qd[i] / s.speed[i],
          .sign = std::tanh(at.qd[i] / kSpeedNoise),
          .u = run.tau[k][i] / s.torque[i],
          .u_rate = rate / s.torque_rate[i],
          .t = 2.0 * static_cast<double>(k) / static_cast<double>(run.rows()) - 1.0,
          .q_other = (at.q[o] - s.middle[o]) / s.half_range[o],
          .v_other = at.qd[o] / s.speed[o],
          .sign_other = std::tanh(at.qd[o] / kSpeedNoise),
          .u_other = run.tau[k][o] / s.torque[o]};
}

}  // namespace teleop
