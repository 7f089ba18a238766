#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include "core/control/gravity.hpp"
#include "core/experiment/arm_rig.hpp"
#include "core/experiment/experiment.hpp"
#include "core/experiment/scenario.hpp"
#include "core/model/kinematics.hpp"

namespace teleop {
namespace {

constexpr double kPushBegins_s = 0.3;
constexpr double kPush_s = 0.02;

/// Mean and deviation of what was seen in a stretch of time.
class Stretch {
 public:
  void add(double value) noexcept {
    sum_ += value;
    squares_ += value * value;
    low_ = count_ == 0.0 ? value : std::min(low_, value);
    high_ = count_ == 0.0 ? value : std::max(high_, value);
    count_ += 1.0;
  }
  [[nodiscard]] bool empty() const noexcept { return count_ == 0.0; }
  [[nodiscard]] double mean() const noexcept { return sum_ / count_; }
  [[nodiscard]] double deviation() const noexcept {
    return std::sqrt(std::max(0.0, squares_ / count_ - mean() * mean()));
  }
  [[nodiscard]] double width() const noexcept { return high_ - low_; }

 private:
  double sum_ = 0.0;
  double squares_ = 0.0;
  double low_ = 0.0;
  double high_ = 0.0;
  double count_ = 0.0;
};

/// A wall that the loop renders through home, across one axis of the tool,
///
///     f = −K x − B ẋ   for x > 0,   0 otherwise,
///
/// pressed by a constant force that the motors add, pushed once for 20 ms, and watched: does the
/// push die away? The other two axes are held by a weak spring; travel is
/// bounded.
class VirtualWallExperiment final : public Experiment {
 public:
  void add_settings(Settings& settings) override {
    settings.add("run.axis", &axis_, "x, y or z; the wall lies towards plus");
    settings.add("run.stiffness_N_per_m", &stiffness_, "K", kNotNegative);
    settings.add("run.damping_Ns_per_m", &damping_, "B", kNotNegative);
    settings.add("run.press_N", &press_N_, "into the wall, always", {.low = 0.1, .high = 8.0});
    settings.add("run.push_N", &push_N_, "into the wall, once for 20 ms",
                 {.low = 0.0, .high = 8.0});
    settings.add("run.hold_N_per_m", &hold_, "spring of the other two axes",
                 {.low = 0.0, .high = 1000.0});
    settings.add("run.travel_limit_mm", &travel_limit_mm_, "ends the run",
                 {.low = 1.0, .high = 50.0});
    settings.add("run.seconds", &seconds_, "how long", {.low = 1.0, .high = 600.0});
    teleop::add_settings(settings, rig_);
  }

  void check(const Scenario& scenario) const override {
    check_integrator(scenario, scenario.plant(), "plant.", {});
    if (axis_ != "x" && axis_ != "y" && axis_ != "z") {
      scenario.refuse("run.axis", "the arm has no such axis; allowed: x, y, z");
    }
    if (press_N_ + push_N_ > rig_.limits.max_force_N) {
      scenario.refuse("run.push_N", "with run.press_N it is more than limits.max_force_N");
    }
  }

  [[nodiscard]] Results run(const Scenario& scenario, ExperimentContext& context) const override {
    ArmRig rig{rig_, scenario, context};
    const ArmModel& model = rig.model();
    const GravityCompensation weight{{}, model};
    const Limiter force_limit{rig_.limits};
    const auto axis = static_cast<Eigen::Index>(axis_[0] - 'x');
    Stretch early;
    Stretch late;
    double ended_s = seconds_;
    Figure::Curve course{.label = "tool"};
    course.points.reserve(static_cast<std::size_t>(seconds_ * rig_.rate_Hz) + 2);
    const double after = kPushBegins_s + kPush_s;
    const double quarter = (seconds_ - after) / 4.0;
    const auto wall = [&](const ArmTurn& turn) noexcept -> std::optional<JointVector> {
      const Matrix3 J = linear_jacobian(model, turn.q);
      const Vector3 p = tool_position(model, turn.q);
      const Vector3 v = J * turn.qd;
      if (turn.t_s >= after && turn.t_s < after + quarter) early.add(p[axis]);
      if (turn.t_s >= seconds_ - quarter) late.add(p[axis]);
      const bool room = course.points.size() < course.points.capacity();
      if (room) course.points.emplace_back(turn.t_s, 1e3 * p[axis]);
      if (p.norm() > 1e-3 * travel_limit_mm_) {
        ended_s = turn.t_s;
        return std::nullopt;
      }
      const bool pushed = turn.t_s >= kPushBegins_s && turn.t_s < after;
      Vector3 f = -hold_ * p;
      f[axis] = press_N_ + (pushed ? push_N_ : 0.0);
      if (p[axis] > 0.0) f[axis] -= stiffness_ * p[axis] + damping_ * v[axis];
      return J.transpose() * force_limit.limit_force(f).f + weight.step(turn.q);
    };
    // An arm whose amplifiers were off does not hang at home.
    if (rig.move_to(JointVector::Zero(), 1.0, 0.3) == ArmRig::Ending::time_over) {
      (void)rig.run(seconds_, wall);
      (void)rig.move_to(JointVector::Zero(), 0.5, 0.2);
    }
    if (context.figures != nullptr) {
      context.figures->push_back({.name = "wall",
                                  .title = "Tool against a virtual wall",
                                  .x_label = "time (s)",
                                  .y_label = "depth (mm)",
                                  .curves = {std::move(course)}});
    }
    return results_of(early, late, ended_s, rig.fault());
  }

 private:
  [[nodiscard]] static Results results_of(const Stretch& early,
                                          const Stretch& late,
                                          double ended_s,
                                          Fault fault) {
    const auto value = [](const Stretch& stretch, double number) {
      return stretch.empty() ? std::nullopt : std::optional{number};
    };
    std::optional<double> growth;
    if (!late.empty() && !early.empty() && early.deviation() > 0.0) {
      growth = late.deviation() / early.deviation();
    }
    return {{"depth_mm", value(late, 1e3 * late.mean()), "mm"},
            {"oscillation_mm", value(late, 1e3 * late.width()), "mm, peak to peak, last quarter"},
            {"growth", growth, "deviation in the last quarter over that after the push"},
            {"ended_s", ended_s, "s"},
            {"fault", static_cast<double>(fault), "number"}};
  }

  std::string axis_ = "x";
  double stiffness_ = 1000.0;
  double damping_ = 0.0;
  double press_N_ = 1.0;
  double push_N_ = 2.0;
  double hold_ = 100.0;
  double travel_limit_mm_ = 10.0;
  double seconds_ = 2.0;
  ArmRig::Config rig_{};
};

}  // namespace

extern const ExperimentKind virtual_wall_experiment;
const ExperimentKind virtual_wall_experiment{
    .name = "virtual_wall",
    .text = "a wall rendered by the loop, pressed and pushed once: does the push die away?",
    .hardware = true,
    .make = []() -> std::unique_ptr<Experiment> {
      return std::make_unique<VirtualWallExperiment>();
    },
};

}  // namespace teleop
