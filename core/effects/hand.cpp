#include "core/effects/hand.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <variant>

#include "core/base/error.hpp"
#include "core/effects/contact.hpp"
#include "core/effects/hand_trace.hpp"

namespace teleop {
namespace {

bool is_size(double value) { return std::isfinite(value) && value >= 0.0; }

constexpr double kPressDepth = 0.01;  // m

}  // namespace

Hand::Hand(const Config& config, HandMotion motion)
    : config_{config}, motion_{std::move(motion)}, end_{next_knot()} {
  if (!is_size(config.stiffness_N_per_m) || !is_size(config.damping_Ns_per_m) ||
      !is_size(config.mass_kg)) {
    throw ConfigError{"hand: stiffness, damping and mass must be finite and 0 or more"};
  }
  next_interval();
}

HandKnot Hand::next_knot() noexcept {
  if (auto* const motion = std::get_if<PointMotion>(&motion_)) return motion->next();
  if (auto* const motion = std::get_if<RepeatedMotion>(&motion_)) return motion->next();
  return std::get_if<ReachMotion>(&motion_)->next();
}

void Hand::next_interval() noexcept {
  const double T = seconds(kKnotPeriod);
  const HandKnot begin = end_;
  end_ = next_knot();
  const Vector3 slope = (end_.p - begin.p) / T;
  cubic_[0] = begin.p;
  cubic_[1] = begin.v;
  cubic_[2] = (3.0 * slope - 2.0 * begin.v - end_.v) / T;
  cubic_[3] = (begin.v + end_.v - 2.0 * slope) / (T * T);
}

double Hand::rate(double tool_mass_kg) const noexcept {
  const double mass = tool_mass_kg + config_.mass_kg;
  return std::max(std::sqrt(config_.stiffness_N_per_m / mass), config_.damping_Ns_per_m / mass);
}

std::optional<Hand> make_hand(const std::string& name,
                              const ArmModel& arm,
                              const Vector3& start,
                              std::uint64_t seed,
                              const Hand::Config& config) {
  using std::chrono::seconds;
  if (name == "none") return std::nullopt;
  if (name == "hold") return Hand{config, PointMotion{start, start, seconds{1}}};
  if (name == "reach") return Hand{config, ReachMotion{{.centre_m = start, .seed = seed}}};
  if (name == "press") {
    const Vector3 goal{kSurfaceOffset + kPressDepth, start.y(), start.z()};
    return Hand{config, PointMotion{start, goal, seconds{2}}};
  }
  return Hand{config, RepeatedMotion{start, closed_loop_of(read_hand_trace(name), arm)}};
}

}  // namespace teleop
