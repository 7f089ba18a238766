#include "core/simulation/linear_axis.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "core/base/error.hpp"
#include "core/math/matrix_exponential.hpp"

namespace teleop {
namespace {

constexpr double kFrictionPiece_ms = 0.25;
constexpr double kLocated_ms = 1e-9;
constexpr int kMostEvents = 64;  ///< in one call; friction that chatters faster is not followed
constexpr double kLongestDelay_s = 0.025;

void check(const LinearAxis::Config& c) {
  const auto refuse = [](const std::string& what) {
    throw ConfigError{"linear axis: " + what};
  };
  const auto is_passive = [](double value) {
    return std::isfinite(value) && value >= 0.0;
  };
  if (!(c.mass_kg > 0.0) || !std::isfinite(c.mass_kg)) refuse("the mass must be positive");
  for (const double value :
       {c.damping_Ns_per_m, c.delay_s, c.lag_s, c.second_mass_kg, c.joint_N_per_m,
        c.joint_damping_Ns_per_m, c.tendon_N_per_m, c.coulomb_N}) {
    if (!is_passive(value)) refuse("every value must be finite and not negative");
  }
  if (c.delay_s > kLongestDelay_s) refuse("the delay is at most 25 ms");
  if (c.second_mass_kg == 0.0 && (c.joint_N_per_m > 0.0 || c.joint_damping_Ns_per_m > 0.0)) {
    refuse("a joint needs a second mass");
  }
}

}  // namespace

LinearAxis::LinearAxis(const Config& config)
    : config_{config}, delay_{static_cast<std::int64_t>(std::llround(config.delay_s * 1e9))} {
  check(config);
  if (config.tendon_N_per_m > 0.0) tendon_m_per_N_ = 1.0 / config.tendon_N_per_m;
  constexpr double kT = 1.0 / kPerSecond;
  Transition A = Transition::Zero();
  const double m1 = config.mass_kg;
  A(kX1, kV1) = 1.0;
  A(kV1, kX1) = -config.joint_N_per_m / m1 * kT * kT;
  A(kV1, kV1) = -(config.damping_Ns_per_m + config.joint_damping_Ns_per_m) / m1 * kT;
  A(kV1, kX2) = config.joint_N_per_m / m1 * kT * kT;
  A(kV1, kV2) = config.joint_damping_Ns_per_m / m1 * kT;
  A(kV1, kF) = kT * kT / m1;
  A(kV1, kFriction) = -kT * kT / m1;
  if (config.second_mass_kg > 0.0) {
    const double m2 = config.second_mass_kg;
    A(kX2, kV2) = 1.0;
    A(kV2, kX1) = config.joint_N_per_m / m2 * kT * kT;
    A(kV2, kV1) = config.joint_damping_Ns_per_m / m2 * kT;
    A(kV2, kX2) = -A(kV2, kX1);
    A(kV2, kV2) = -A(kV2, kV1);
  }
  if (config.lag_s > 0.0) {
    A(kF, kF) = -kT / config.lag_s;
    A(kF, kU) = kT / config.lag_s;
  }
  forms_[0].A = A;
  A.row(kV1).setZero();
  forms_[1].A = A;
  choose_form();
}

void LinearAxis::command(double force_N) noexcept {
  if (waiting_ == kQueue) --waiting_;
  queue_[(first_ + waiting_) % kQueue] = {.at = now_ + delay_, .force_N = force_N};
  ++waiting_;
  switch_commands();
}

void LinearAxis::release() noexcept {
  waiting_ = 0;
  z_[kF] = 0.0;
  z_[kU] = 0.0;
  choose_form();
}

Duration LinearAxis::until_switch() const noexcept {
  return waiting_ == 0 ? Duration::max() : queue_[first_].at - now_;
}

void LinearAxis::switch_commands() noexcept {
  const bool due = waiting_ > 0 && queue_[first_].at <= now_;
  while (waiting_ > 0 && queue_[first_].at <= now_) {
    z_[kU] = queue_[first_].force_N;
    first_ = (first_ + 1) % kQueue;
    --waiting_;
  }
  if (!due) return;
  if (config_.lag_s == 0.0) z_[kF] = z_[kU];
  choose_form();
}

void LinearAxis::advance(Duration span) noexcept {
  if (span > Duration{0}) {
    const double span_ms = seconds(span) * kPerSecond;
    if (config_.coulomb_N > 0.0) {
      flow_with_friction(span_ms);
    } else {
      z_ = transition(span_ms) * z_;
    }
    now_ += span;
  }
  switch_commands();
}

const LinearAxis::Transition& LinearAxis::transition(double span_ms) noexcept {
  Form& form = forms_[stuck_ ? 1 : 0];
  for (const Cached& cached : form.cache) {
    // Exact equality is meant: the same span, not a near one.
    if (cached.span_ms == span_ms) return cached.phi;
  }
  Cached& slot = form.cache[form.next];
  form.next = (form.next + 1) % form.cache.size();
  slot = {.span_ms = span_ms, .phi = matrix_exponential<Transition>(form.A * span_ms)};
  return slot.phi;
}

/// Force on m₁ without friction.
double LinearAxis::net_force() const noexcept {
  const double total =
      (forms_[0].A.row(kV1) * z_).value() * config_.mass_kg * kPerSecond * kPerSecond;
  return total + z_[kFriction];
}

void LinearAxis::choose_form() noexcept {
  if (config_.coulomb_N == 0.0) return;
  if (z_[kV1] != 0.0) {
    stuck_ = false;
    z_[kFriction] = std::copysign(config_.coulomb_N, z_[kV1]);
    return;
  }
  const double net = net_force();
  stuck_ = std::abs(net) <= config_.coulomb_N;
  z_[kFriction] = stuck_ ? 0.0 : std::copysign(config_.coulomb_N, net);
}

/// Not negative while the form holds: speed along the friction, or what friction can still hold.
double LinearAxis::margin(const State& z) const noexcept {
  if (!stuck_) return z[kV1] * z[kFriction];
  const double net = (forms_[0].A.row(kV1) * z).value() * config_.mass_kg * kPerSecond * kPerSecond;
  return config_.coulomb_N - std::abs(net);
}

/// Bisection on the exact flow; the form holds at 0 and not at span.
double LinearAxis::locate(double span_ms) const noexcept {
  const Transition& A = forms_[stuck_ ? 1 : 0].A;
  double low = 0.0;
  double high = span_ms;
  while (high - low > kLocated_ms) {
    const double middle = 0.5 * (low + high);
    const State z = matrix_exponential<Transition>(A * middle) * z_;
    (margin(z) >= 0.0 ? low : high) = middle;
  }
  return high;
}

void LinearAxis::flow_with_friction(double span_ms) noexcept {
  double left = span_ms;
  int events = 0;
  while (left > 0.0) {
    double piece = std::min(left, kFrictionPiece_ms);
    State end = transition(piece) * z_;
    const bool changes = margin(end) < 0.0 && events < kMostEvents;
    if (changes) {
      ++events;
      piece = locate(piece);
      end = matrix_exponential<Transition>(forms_[stuck_ ? 1 : 0].A * piece) * z_;
      if (!stuck_) end[kV1] = 0.0;
    }
    z_ = end;
    left -= piece;
    if (!changes) continue;
    if (stuck_) {
      const double net = net_force();
      stuck_ = false;
      z_[kFriction] = std::copysign(config_.coulomb_N, net);
    } else {
      choose_form();
    }
  }
}

double LinearAxis::reading_rate() const noexcept {
  const double force_rate = (forms_[0].A.row(kF) * z_).value();
  return (z_[kV1] + force_rate * tendon_m_per_N_) * kPerSecond;
}

double LinearAxis::kinetic_energy() const noexcept {
  const double v1 = z_[kV1] * kPerSecond;
  const double v2 = z_[kV2] * kPerSecond;
  return 0.5 * (config_.mass_kg * v1 * v1 + config_.second_mass_kg * v2 * v2);
}

}  // namespace teleop
