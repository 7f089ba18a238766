#include "core/identification/periodic_drive.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/base/contract.hpp"
#include "core/model/dynamics.hpp"
#include "core/model/kinematics.hpp"

namespace teleop {
namespace {

constexpr double kCrossing_s = 0.8;  ///< from one reference to the next
constexpr double kSettle_s = 1.5;
constexpr double kWatch_s = 0.2;
constexpr double kFade_s = 0.05;    ///< short: an arm with weight falls meanwhile
constexpr double kRest_m = 0.5e-3;  ///< moving less than this in kWatch_s is rest

}  // namespace

std::string_view text_of(DriveEnd end) noexcept {
  switch (end) {
    case DriveEnd::running:
      return "not finished";
    case DriveEnd::done:
      return "done";
    case DriveEnd::travel:
      return "the tool left its travel";
    case DriveEnd::speed:
      return "the tool went too fast";
    case DriveEnd::torque_cut:
      return "the device cut the torque";
    case DriveEnd::device_fault:
      return "the device reported a fault";
    case DriveEnd::interrupted:
      return "interrupted";
  }
  return "unknown";
}

PeriodicDrive::PeriodicDrive(const Config& config,
                             const ArmModel& model,
                             std::vector<Segment> segments,
                             const std::atomic<bool>& stop)
    : config_{config},
      model_{model},
      segments_{std::move(segments)},
      stop_{stop},
      velocity_{{.cutoff_Hz = config.cutoff_Hz}} {
  expects(config.axis < kJoints && !segments_.empty(), "an axis and something to play");
  for (const Segment& segment : segments_) {
    const Eigen::Index samples = segment.reference_N.size();
    const auto periods = static_cast<Eigen::Index>(segment.periods);
    kept_.push_back({.record = {.reference_N = segment.reference_N,
                                .force_N = Eigen::MatrixXd::Zero(samples, periods),
                                .position_m = Eigen::MatrixXd::Zero(samples, periods)},
                     .whole = std::vector<std::uint8_t>(segment.periods, 1)});
  }
}

double PeriodicDrive::overhead_s(const Config& config) noexcept {
  return config.centring_s + kSettle_s + kWatch_s + kFade_s;
}

std::uint64_t PeriodicDrive::samples_of(double duration_s) const noexcept {
  return static_cast<std::uint64_t>(std::lround(duration_s * config_.rate_Hz));
}

Next PeriodicDrive::step(Arm& arm, const Tick& tick) noexcept {
  const ArmState state = arm.read();
  if (!begun_) {
    begin(state);
    arm.amplifiers(true);
  }
  observe(state, tick);
  if (state.fault != Fault::none || !state.q.allFinite()) {
    outcome_.end = DriveEnd::device_fault;
    outcome_.fault = state.fault == Fault::none ? Fault::state_not_finite : state.fault;
  }
  if (must_end()) {
    arm.write(JointVector::Zero());
    arm.amplifiers(false);
    if (outcome_.end == DriveEnd::running) outcome_.end = DriveEnd::done;
    return Next::stop;
  }
  check(state);

  Vector3 F = hold(seconds(tick.elapsed));
  const auto axis = static_cast<Eigen::Index>(config_.axis);
  if (phase_ == Phase::playing) F[axis] += play();
  const double left = phase_ == Phase::fading ? 1.0 - static_cast<double>(in_phase_) /
                                                          static_cast<double>(samples_of(kFade_s))
                                              : 1.0;
  F *= left;
  const double size = F.norm();
  if (size > config_.max_force_N) {
    F *= config_.max_force_N / size;
    ++outcome_.shortened;
  }
  outcome_.largest_force_N = std::max(outcome_.largest_force_N, F.norm());
  if (phase_ == Phase::playing) keep(F[axis]);
  arm.write(J_.transpose() * F + left * config_.gravity_share * gravity_torque(model_, state.q));
  advance_phase();
  return Next::again;
}

bool PeriodicDrive::must_end() const noexcept {
  const bool faded = phase_ == Phase::fading && in_phase_ >= samples_of(kFade_s);
  // The weak loop did not hold the arm: only torque that is off is safe.
  const bool lost = !p_.allFinite() || p_.cwiseAbs().maxCoeff() > 2.0 * config_.max_travel_m;
  return outcome_.end == DriveEnd::device_fault || faded ||
         (outcome_.end != DriveEnd::running && lost);
}

void PeriodicDrive::begin(const ArmState& state) noexcept {
  begun_ = true;
  q_0_ = config_.q_0.value_or(state.q);
  J_ = linear_jacobian(model_, q_0_);
  start_m_ = (J_ * (state.q - q_0_)).norm();
}

void PeriodicDrive::observe(const ArmState& state, const Tick& tick) noexcept {
  const std::uint64_t sample = tick.index + tick.missed;
  just_missed_ = tick.index == 0 ? 0 : sample - last_sample_ - 1;
  last_sample_ = sample;
  outcome_.missed = tick.missed;
  in_phase_ += just_missed_;
  p_ = J_ * (state.q - q_0_);
  v_ = J_ * velocity_.step({.q = state.q, .dt = seconds(tick.elapsed)});
}

void PeriodicDrive::check(const ArmState& state) noexcept {
  const double travel = p_.cwiseAbs().maxCoeff();
  outcome_.largest_speed_m_per_s = std::max(outcome_.largest_speed_m_per_s, v_.norm());
  double limit = config_.max_travel_m;
  if (phase_ == Phase::centring) {
    limit += 2.0 * start_m_;
  } else {
    outcome_.largest_travel_m = std::max(outcome_.largest_travel_m, travel);
  }
  if (phase_ != Phase::centring && phase_ != Phase::playing) return;
  if (stop_.load(std::memory_order_relaxed)) brake(DriveEnd::interrupted);
  if (state.has(ArmFlag::torque_cut)) brake(DriveEnd::torque_cut);
  if (v_.norm() > config_.max_speed_m_per_s) brake(DriveEnd::speed);
  if (travel > limit) brake(DriveEnd::travel);
}

void PeriodicDrive::brake(DriveEnd why) noexcept {
  outcome_.end = why;
  enter(Phase::settling);
}

Vector3 PeriodicDrive::hold(double dt) noexcept {
  if (phase_ == Phase::centring) {
    const double K = config_.centring_stiffness_N_per_m;
    weight_ -= config_.integral_per_s * K * dt * p_;
    return weight_ - K * p_ - config_.centring_damping_Ns_per_m * v_;
  }
  return weight_ - config_.stiffness_N_per_m * p_ - config_.damping_Ns_per_m * v_;
}

double PeriodicDrive::play() noexcept {
  if (just_missed_ > 0) skip();
  // A soft passage from the reference before, or a jump in speed would throw the arm off its place.
  const auto crossing = static_cast<double>(samples_of(kCrossing_s));
  const double share = std::min(1.0, static_cast<double>(in_segment_) / crossing);
  const double now = 0.5 - 0.5 * std::cos(std::numbers::pi * share);
  const double before = segment_ == 0 ? 0.0 : sample(segment_ - 1);
  return now * sample(segment_) + (1.0 - now) * before;
}

double PeriodicDrive::sample(std::size_t segment) const noexcept {
  const Eigen::VectorXd& reference = segments_[segment].reference_N;
  return reference(static_cast<Eigen::Index>(in_segment_) % reference.size());
}

void PeriodicDrive::skip() noexcept {
  // The holding loop was late too: the period after still hears the echo.
  const Segment& segment = segments_[segment_];
  const auto length = static_cast<std::uint64_t>(segment.reference_N.size());
  const std::uint64_t settle = segment.settle_periods * length;
  const std::uint64_t last = settle + segment.periods * length - 1;
  const std::uint64_t next = std::min(in_segment_ + just_missed_, last);
  for (std::size_t p = 0; p < segment.periods; ++p) {
    const std::uint64_t first = settle + p * length;
    if (first <= next + length && first + length > in_segment_) kept_[segment_].whole[p] = 0;
  }
  in_segment_ = next;
}

void PeriodicDrive::keep(double force_N) noexcept {
  const Segment& segment = segments_[segment_];
  const auto length = static_cast<std::uint64_t>(segment.reference_N.size());
  const std::uint64_t settle = segment.settle_periods * length;
  if (in_segment_ >= settle && in_segment_ < settle + segment.periods * length) {
    const auto row = static_cast<Eigen::Index>((in_segment_ - settle) % length);
    const auto column = static_cast<Eigen::Index>((in_segment_ - settle) / length);
    kept_[segment_].record.force_N(row, column) = force_N;
    kept_[segment_].record.position_m(row, column) = p_[static_cast<Eigen::Index>(config_.axis)];
  }
  ++in_segment_;
  if (in_segment_ >= settle + segment.periods * length) {
    in_segment_ = 0;
    ++segment_;
  }
}

void PeriodicDrive::enter(Phase phase) noexcept {
  phase_ = phase;
  in_phase_ = 0;
}

void PeriodicDrive::advance_phase() noexcept {
  ++in_phase_;
  switch (phase_) {
    case Phase::centring:
      if (in_phase_ >= samples_of(config_.centring_s)) enter(Phase::playing);
      return;
    case Phase::playing:
      if (segment_ == segments_.size()) enter(Phase::settling);
      return;
    case Phase::settling:
      if (in_phase_ < samples_of(kSettle_s)) return;
      lowest_ = p_;
      highest_ = p_;
      enter(Phase::watching);
      return;
    case Phase::watching:
      lowest_ = lowest_.cwiseMin(p_);
      highest_ = highest_.cwiseMax(p_);
      if (in_phase_ < samples_of(kWatch_s)) return;
      outcome_.at_rest = (highest_ - lowest_).maxCoeff() < kRest_m;
      enter(Phase::fading);
      return;
    case Phase::fading:
      return;
  }
}

std::vector<PeriodicRecord> PeriodicDrive::records() const {
  std::vector<PeriodicRecord> result;
  for (const Kept& kept : kept_) {
    PeriodicRecord record{.reference_N = kept.record.reference_N, .force_N = {}, .position_m = {}};
    Eigen::Index columns = 0;
    record.force_N.resize(record.reference_N.size(), kept.record.force_N.cols());
    record.position_m = record.force_N;
    for (std::size_t p = 0; p < kept.whole.size(); ++p) {
      if (kept.whole[p] == 0) continue;
      record.force_N.col(columns) = kept.record.force_N.col(static_cast<Eigen::Index>(p));
      record.position_m.col(columns) = kept.record.position_m.col(static_cast<Eigen::Index>(p));
      ++columns;
    }
    record.force_N.conservativeResize(Eigen::NoChange, columns);
    record.position_m.conservativeResize(Eigen::NoChange, columns);
    result.push_back(std::move(record));
  }
  return result;
}

}  // namespace teleop
