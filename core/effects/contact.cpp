#include "core/effects/contact.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "core/base/error.hpp"

namespace teleop {
namespace {

/// The depth in m for which rate() is meant: a soft block is rarely pressed further.
constexpr double kDeepest = 0.02;

void require(bool condition, const char* what) {
  if (!condition) throw ConfigError{fmt::format("contact: {}", what)};
}

double power_law(double p, double exponent) noexcept {
  return exponent == 1.5 ? p * std::sqrt(p) : std::pow(p, exponent);
}

}  // namespace

Contact::Contact(const Config& config) : config_{config} {
  require(config.point_m.allFinite() && config.normal.allFinite(), "point and normal: not finite");
  require(std::isfinite(config.stiffness) && config.stiffness > 0.0, "stiffness must be positive");
  require(std::isfinite(config.damping) && config.damping >= 0.0, "damping must be 0 or more");
  if (config.law == Law::hunt_crossley) {
    require(std::isfinite(config.exponent) && config.exponent >= 1.0, "exponent must be 1 or more");
  }
  if (config.shape == Shape::sphere) {
    require(std::isfinite(config.radius_m) && config.radius_m > 0.0, "radius must be positive");
  } else {
    require(config.normal.norm() > 1e-9, "normal must have a length");
    config_.normal.normalize();
  }
}

Contact::Depth Contact::depth(const Vector3& p_BT, const Vector3& v_BT) const noexcept {
  const Vector3 from = p_BT - config_.point_m;
  if (config_.shape == Shape::plane) {
    return {.p = -config_.normal.dot(from),
            .p_rate = -config_.normal.dot(v_BT),
            .normal = config_.normal};
  }
  const double distance = from.norm();
  const Vector3 normal = distance > 0.0 ? Vector3{from / distance} : config_.normal;
  return {.p = config_.radius_m - distance, .p_rate = -normal.dot(v_BT), .normal = normal};
}

double Contact::push_margin(const Depth& depth) const noexcept {
  if (config_.law == Law::spring_damper) {
    return std::min(depth.p, depth.p + config_.damping / config_.stiffness * depth.p_rate);
  }
  return depth.p * std::min(1.0, depth.p > 0.0 ? 1.0 + config_.damping * depth.p_rate : 1.0);
}

double Contact::smooth_force(const Depth& depth) const noexcept {
  if (config_.law == Law::spring_damper) {
    return config_.stiffness * depth.p + config_.damping * depth.p_rate;
  }
  return config_.stiffness * power_law(std::max(depth.p, 0.0), config_.exponent) *
         (1.0 + config_.damping * depth.p_rate);
}

double Contact::stored_energy(const Depth& depth) const noexcept {
  const double p = std::max(depth.p, 0.0);
  if (config_.law == Law::spring_damper) return config_.stiffness * p * p / 2.0;
  return config_.stiffness * p * power_law(p, config_.exponent) / (config_.exponent + 1.0);
}

double Contact::rate(double mass_kg) const noexcept {
  if (config_.law == Law::spring_damper) {
    return std::max(std::sqrt(config_.stiffness / mass_kg), config_.damping / mass_kg);
  }
  const double e = config_.exponent;
  const double stiffness = e * config_.stiffness * std::pow(kDeepest, e - 1.0);
  const double damping = config_.stiffness * power_law(kDeepest, e) * config_.damping;
  return std::max(std::sqrt(stiffness / mass_kg), damping / mass_kg);
}

std::optional<Contact> environment(std::string_view name) {
  if (name == "free") return std::nullopt;
  Contact::Config surface{.point_m = {kSurfaceOffset, 0.0, 0.0}, .normal = {-1.0, 0.0, 0.0}};
  if (name == "wall") {
    // Assumed: about ten times the largest stable gain of a pair, so that the coupling is the
    // softest spring of the chain; damping about a fifth of critical with the 77 g of the arm along
    // x.
    surface.stiffness = 1e4;
    surface.damping = 10.0;
    return Contact{surface};
  }
  if (name == "soft") {
    // Assumed: foam, 1 N presses it 5 mm; λ so large that a tap at 0.1 m/s hardly rebounds.
    surface.law = Contact::Law::hunt_crossley;
    surface.stiffness = 3000.0;
    surface.exponent = 1.5;
    surface.damping = 2.0;
    return Contact{surface};
  }
  throw ConfigError{fmt::format("unknown environment '{}'; allowed: free, soft, wall", name)};
}

}  // namespace teleop
