#include "core/simulation/actuation.hpp"

#include <algorithm>
#include <cmath>

namespace teleop {
namespace {

constexpr double kSoon = 1e-13;       // s: rounding of sums of instants
constexpr double kLeastShare = 0.2;   // of the torque, however hot
constexpr double kHeatTorque = 0.03;  // N m
constexpr std::size_t kHistory = 1024;

bool is_plain(const ActuationTerms& terms) {
  const bool coupled = std::any_of(terms.coupling.begin(), terms.coupling.end(),
                                   [](double share) { return share != 0.0; });
  return terms.delay == 0.0 && std::isinf(terms.limit) && terms.threshold == 0.0 &&
         terms.gain == 1.0 && terms.loss == 0.0 && terms.lag == 0.0 && terms.bias == 0.0 &&
         !coupled;
}

}  // namespace

ActuationChain::ActuationChain(const std::array<ActuationTerms, kJoints>& terms) : terms_{terms} {
  for (std::size_t i = 0; i < kJoints; ++i) {
    plain_ = plain_ && is_plain(terms[i]);
    delays_ = delays_ || terms[i].delay > 0.0;
    axes_[i].offset = terms[i].bias;
  }
  if (delays_) history_.resize(kHistory);
}

double ActuationChain::Axis::at(double dt) const noexcept {
  double a = c0;
  if (c1 != 0.0) a += c1 * std::exp(-rate1 * dt);
  if (c2 != 0.0) a += c2 * std::exp(-rate2 * dt);
  return a;
}

void ActuationChain::command(const JointVector& u) noexcept {
  u_ = u;
  if (plain_) return;
  if (delays_) {
    history_[commands_ % kHistory] = {.at = now_, .u = u};
    ++commands_;
  }
  for (std::size_t i = 0; i < kJoints; ++i) {
    Axis& axis = axes_[i];
    axis.offset = terms_[i].bias;
    for (std::size_t from = 0; from < kJoints; ++from) {
      axis.offset += terms_[i].coupling[from] * u[static_cast<Eigen::Index>(from)];
    }
    if (terms_[i].delay == 0.0 || !started_) {
      arrive(i, u[static_cast<Eigen::Index>(i)]);
      axis.waiting = commands_;
    } else if (commands_ - axis.waiting > kHistory) {
      axis.waiting = commands_ - kHistory;  // faster than any loop: the oldest are lost
    }
  }
  started_ = true;
}

void ActuationChain::arrive(std::size_t i, double u) noexcept {
  const ActuationTerms& terms = terms_[i];
  const double cut = std::clamp(u, -terms.limit, terms.limit);
  const double beyond = std::max(std::abs(cut) - terms.threshold, 0.0);
  const double before = axes_[i].at(0.0);  // the lag goes on from there
  axes_[i].arrived = terms.threshold > 0.0 ? std::copysign(beyond, cut) : cut;
  shape(i, before);
  if (!started_) {  // as if it had been given for ever
    axes_[i].c2 = 0.0;
  }
}

/// Chooses c0, c1, c2 for what has arrived, the present heat and the present delivered torque.
void ActuationChain::shape(std::size_t i, double a) noexcept {
  const ActuationTerms& terms = terms_[i];
  Axis& axis = axes_[i];
  const double level = terms.gain * axis.arrived;
  double w0 = level;
  double w1 = 0.0;
  double rate = 0.0;
  axis.form_ends = std::numeric_limits<double>::infinity();
  if (terms.loss > 0.0) {
    const double ratio = axis.arrived / kHeatTorque;
    const double final_heat = ratio * ratio;
    const double clamp_heat = (1.0 - kLeastShare) / terms.loss;
    const bool clamped =
        axis.heat > clamp_heat || (axis.heat == clamp_heat && final_heat > clamp_heat);
    rate = 1.0 / terms.thermal_time_constant;
    if (clamped) {
      w0 = kLeastShare * level;
    } else {
      w0 = level * (1.0 - terms.loss * final_heat);
      w1 = -level * terms.loss * (axis.heat - final_heat);
    }
    const double passed = (axis.heat - final_heat) / (clamp_heat - final_heat);
    if (passed > 1.0) axis.form_ends = terms.thermal_time_constant * std::log(passed);
  }
  axis.rate1 = rate;
  if (terms.lag <= 0.0) {
    axis.c0 = w0;
    axis.c1 = w1;
    axis.c2 = 0.0;
    return;
  }
  double share = 1.0 - rate * terms.lag;
  if (std::abs(share) < 1e-7) share = 1e-7;  // equal time constants: apart by so little
  axis.c0 = w0;
  axis.c1 = w1 / share;
  axis.c2 = a - axis.c0 - axis.c1;
  axis.rate2 = 1.0 / terms.lag;
}

double ActuationChain::until_arrival(std::size_t i) const noexcept {
  if (terms_[i].delay == 0.0 || axes_[i].waiting == commands_) {
    return std::numeric_limits<double>::infinity();
  }
  return std::max(history_[axes_[i].waiting % kHistory].at + terms_[i].delay - now_, 0.0);
}

double ActuationChain::next_change() const noexcept {
  double next = std::numeric_limits<double>::infinity();
  if (plain_) return next;
  for (std::size_t i = 0; i < kJoints; ++i) {
    next = std::min({next, until_arrival(i), axes_[i].form_ends});
  }
  return next;
}

void ActuationChain::advance(double dt) noexcept {
  if (plain_) return;
  now_ += dt;
  for (std::size_t i = 0; i < kJoints; ++i) {
    Axis& axis = axes_[i];
    const ActuationTerms& terms = terms_[i];
    const double a = axis.at(dt);
    if (terms.loss > 0.0) {
      const double ratio = axis.arrived / kHeatTorque;
      axis.heat =
          ratio * ratio + (axis.heat - ratio * ratio) * std::exp(-dt / terms.thermal_time_constant);
    }
    axis.form_ends -= dt;
    if (axis.form_ends <= kSoon) {
      axis.heat = (1.0 - kLeastShare) / terms.loss;
      shape(i, a);
    } else {
      axis.c1 *= std::exp(-axis.rate1 * dt);
      axis.c2 *= std::exp(-axis.rate2 * dt);
    }
    while (until_arrival(i) <= kSoon) {
      const JointVector& u = history_[axis.waiting % kHistory].u;
      ++axis.waiting;
      arrive(i, u[static_cast<Eigen::Index>(i)]);
    }
  }
}

bool ActuationChain::constant() const noexcept {
  return plain_ || std::all_of(axes_.begin(), axes_.end(), [](const Axis& axis) {
           return axis.c1 == 0.0 && std::abs(axis.c2) < 1e-15;
         });
}

}  // namespace teleop
