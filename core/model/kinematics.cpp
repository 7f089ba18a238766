#include "core/model/kinematics.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace teleop {
namespace {

using std::numbers::pi;

/// Below this share of l1 + l2 a length counts as none.
constexpr double kNegligible = 1e-9;

struct Angles {
  double c1, s1, c2, s2, c3, s3;

  explicit Angles(const JointVector& q) noexcept
      : c1{std::cos(q[0])},
        s1{std::sin(q[0])},
        c2{std::cos(q[1])},
        s2{std::sin(q[1])},
        c3{std::cos(q[2])},
        s3{std::sin(q[2])} {}

  [[nodiscard]] double rho(const ArmParameters& arm) const noexcept {
    return arm.l1_m * c2 + arm.l2_m * s3;
  }
  [[nodiscard]] Vector3 tool(const ArmParameters& arm) const noexcept {
    const double r = rho(arm);
    return {s1 * r, arm.l2_m - arm.l2_m * c3 + arm.l1_m * s2, c1 * r - arm.l1_m};
  }
  [[nodiscard]] Matrix3 linear_jacobian(const ArmParameters& arm) const noexcept {
    const double r = rho(arm);
    const double l1 = arm.l1_m;
    const double l2 = arm.l2_m;
    Matrix3 J;
    J << c1 * r, -l1 * s1 * s2, l2 * s1 * c3,  //
        0.0, l1 * c2, l2 * s3,                 //
        -s1 * r, -l1 * c1 * s2, l2 * c1 * c3;
    return J;
  }
};

double wrapped(double angle) noexcept { return std::remainder(angle, 2.0 * pi); }

}  // namespace

Pose forward_kinematics(const ArmModel& arm, const JointVector& q) noexcept {
  const Angles a{q};
  Pose X_BT;
  X_BT.R << a.c1, -a.s1 * a.s3, a.s1 * a.c3,  //
      0.0, a.c3, a.s3,                        //
      -a.s1, -a.c1 * a.s3, a.c1 * a.c3;
  X_BT.p = a.tool(arm.parameters());
  return X_BT;
}

Vector3 tool_position(const ArmModel& arm, const JointVector& q) noexcept {
  return Angles{q}.tool(arm.parameters());
}

Jacobian body_jacobian(const ArmModel& arm, const JointVector& q) noexcept {
  const Angles a{q};
  const ArmParameters& parameters = arm.parameters();
  Jacobian J = Jacobian::Zero();
  J(0, 0) = a.rho(parameters);
  J(1, 1) = parameters.l1_m * (a.c2 * a.c3 + a.s2 * a.s3);
  J(2, 1) = -parameters.l1_m * (a.s2 * a.c3 - a.c2 * a.s3);
  J(2, 2) = parameters.l2_m;
  J(3, 2) = -1.0;
  J(4, 0) = a.c3;
  J(5, 0) = a.s3;
  return J;
}

Jacobian hybrid_jacobian(const ArmModel& arm, const JointVector& q) noexcept {
  const Angles a{q};
  Jacobian J;
  J.topRows<3>() = a.linear_jacobian(arm.parameters());
  J.bottomRows<3>() << 0.0, 0.0, -a.c1,  //
      1.0, 0.0, 0.0,                     //
      0.0, 0.0, a.s1;
  return J;
}

Matrix3 linear_jacobian(const ArmModel& arm, const JointVector& q) noexcept {
  return Angles{q}.linear_jacobian(arm.parameters());
}

Matrix3 linear_jacobian_rate(const ArmModel& arm,
                             const JointVector& q,
                             const JointVector& qd) noexcept {
  const auto [c1, s1, c2, s2, c3, s3] = Angles{q};
  const double l1 = arm.parameters().l1_m;
  const double l2 = arm.parameters().l2_m;
  const double rho = l1 * c2 + l2 * s3;
  const double rho_rate = -l1 * s2 * qd[1] + l2 * c3 * qd[2];
  Matrix3 rate;
  rate << c1 * rho_rate - s1 * rho * qd[0],       //
      -l1 * (c1 * s2 * qd[0] + s1 * c2 * qd[1]),  //
      l2 * (c1 * c3 * qd[0] - s1 * s3 * qd[2]),   //
      0.0, -l1 * s2 * qd[1], l2 * c3 * qd[2],     //
      -s1 * rho_rate - c1 * rho * qd[0],          //
      l1 * (s1 * s2 * qd[0] - c1 * c2 * qd[1]),   //
      -l2 * (s1 * c3 * qd[0] + c1 * s3 * qd[2]);
  return rate;
}

double manipulability(const ArmModel& arm, const JointVector& q) noexcept {
  // In the tool frame J_v is |ρ| beside a triangle ((a, 0), (b, c)), whose singular values have the
  // sum √((|a| + |c|)² + b²) and the product |a c|.
  const double a = arm.parameters().l1_m * std::cos(q[1] - q[2]);
  const double b = arm.parameters().l1_m * std::sin(q[1] - q[2]);
  const double c = arm.parameters().l2_m;
  const double rho =
      std::abs(arm.parameters().l1_m * std::cos(q[1]) + arm.parameters().l2_m * std::sin(q[2]));
  const double larger =
      (std::sqrt((a + c) * (a + c) + b * b) + std::sqrt((a - c) * (a - c) + b * b)) / 2.0;
  const double smaller = std::abs(a * c) / larger;
  return std::min(rho, smaller) / std::max(rho, larger);
}

std::string_view text_of(Reach reach) noexcept {
  static constexpr std::array<std::string_view, 12> kTexts{
      "ok",
      "too far from the shoulder",
      "too near to the shoulder",
      "joint 1 below its stop",
      "joint 1 above its stop",
      "joint 2 below its stop",
      "joint 2 above its stop",
      "joint 3 below its stop",
      "joint 3 above its stop",
      "coupled stop: q2 - q3 too large",
      "coupled stop: q3 - q2 too large",
      "not a finite number",
  };
  const auto index = static_cast<std::size_t>(reach);
  return index < kTexts.size() ? kTexts[index] : "unknown";
}

IkResult inverse_kinematics(const ArmModel& arm,
                            const Vector3& p_BT,
                            IkBranch branch,
                            double previous_q1) noexcept {
  if (!p_BT.allFinite() || !std::isfinite(previous_q1)) return {.reach = Reach::not_finite};
  const double l1 = arm.parameters().l1_m;
  const double l2 = arm.parameters().l2_m;
  const double farthest = l1 + l2;
  const double nearest = std::abs(l1 - l2);
  const bool flip = branch == IkBranch::flip_up || branch == IkBranch::flip_down;
  const bool up = branch == IkBranch::up || branch == IkBranch::flip_up;

  // Shoulder to tool: distance d from the yaw axis, height, length r, elevation.
  const double forward = p_BT.z() + l1;
  const double height = p_BT.y() - l2;
  const double d = std::sqrt(p_BT.x() * p_BT.x() + forward * forward);
  const double distance = std::sqrt(d * d + height * height);
  const double r = std::clamp(distance, nearest, farthest);
  const double elevation = std::atan2(height, flip ? -d : d);

  // Half angles instead of the law of cosines: no acos, which loses half the digits at its ends.
  // α is the elbow's interior angle, β the shoulder's, between upper arm and tool direction.
  const double u = std::sqrt((r - nearest) * (r + nearest));
  const double v = std::sqrt((farthest - r) * (farthest + r));
  const double alpha = 2.0 * std::atan2(u, v);
  const double beta = std::atan2(2.0 * u * v, 4.0 * l1 * l1 + (u - v) * (u + v));

  IkResult result;
  const double yaw = std::atan2(p_BT.x(), forward);
  const bool on_axis = d < kNegligible * farthest;
  result.q[0] = on_axis ? previous_q1 : flip ? wrapped(yaw + pi) : yaw;
  result.q[1] = wrapped(up ? elevation + beta : elevation - beta);
  result.q[2] = result.q[1] + (up ? alpha - pi / 2.0 : wrapped(-alpha - pi / 2.0));

  if (distance > farthest * (1.0 + kNegligible)) {
    result.reach = Reach::too_far;
  } else if (distance < nearest - kNegligible * farthest) {
    result.reach = Reach::too_near;
  } else {
    result.reach = check_limits(arm, result.q);
  }
  return result;
}

Reach check_limits(const ArmModel& arm, const JointVector& q) noexcept {
  if (!q.allFinite()) return Reach::not_finite;
  static constexpr std::array kLow{Reach::joint1_low, Reach::joint2_low, Reach::joint3_low};
  static constexpr std::array kHigh{Reach::joint1_high, Reach::joint2_high, Reach::joint3_high};
  const ArmParameters& parameters = arm.parameters();
  for (std::size_t i = 0; i < kJoints; ++i) {
    const double angle = q[static_cast<Eigen::Index>(i)];
    if (angle < parameters.lower_limit_rad[i]) return kLow[i];
    if (angle > parameters.upper_limit_rad[i]) return kHigh[i];
  }
  if (q[1] - q[2] > parameters.max_q2_minus_q3_rad) return Reach::q2_minus_q3;
  if (q[2] - q[1] > parameters.max_q3_minus_q2_rad) return Reach::q3_minus_q2;
  return Reach::ok;
}

}  // namespace teleop
