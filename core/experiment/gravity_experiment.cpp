#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <vector>

#include <fmt/format.h>

#include "core/control/gravity.hpp"
#include "core/experiment/arm_rig.hpp"
#include "core/experiment/experiment.hpp"
#include "core/experiment/scenario.hpp"
#include "core/model/kinematics.hpp"

namespace teleop {
namespace {

/// A posture to rest in, and where that is between home and the edge of the workspace.
struct Pose {
  JointVector q = JointVector::Zero();
  double angle_rad = 0.0;  ///< of the ray from home in the plane x = 0, 0 along y
  double distance_m = 0.0;
};

/// How far the tool went from where it was let go.
struct Drift {
  double end_m = 0.0;
  std::vector<std::pair<double, double>> course;  ///< s, mm
};

/// How far the stops let the tool go from home along a ray.
double edge_along(const ArmModel& model, const Vector3& direction) {
  constexpr double kStep = 0.001;
  double reached = 0.0;
  for (int i = 1; i < 1000; ++i) {
    const double distance = kStep * i;
    if (inverse_kinematics(model, distance * direction).reach != Reach::ok) break;
    reached = distance;
  }
  return reached;
}

/// The arm is taken to poses along rays from home to the edge of the workspace, let go at rest, and
/// watched: once carried by gravity compensation, once not at all. A drift that reaches its limit
/// ends the look, and the servo catches the arm.
class GravityExperiment final : public Experiment {
 public:
  void add_settings(Settings& settings) override {
    settings.add("run.directions", &directions_, "rays from home in the plane x = 0",
                 {.low = 1.0, .high = 64.0});
    settings.add("run.steps", &steps_, "poses a ray, home not counted", {.low = 1.0, .high = 32.0});
    settings.add("run.edge_share", &edge_share_, "of the way to the edge where the last pose is",
                 {.low = 0.05, .high = 0.99});
    settings.add("run.seconds", &seconds_, "each look at an arm let go",
                 {.low = 0.1, .high = 60.0});
    settings.add("run.drift_limit_mm", &drift_limit_mm_, "ends a look", {.low = 1.0, .high = 50.0});
    teleop::add_settings(settings, "gravity.", gravity_);
    teleop::add_settings(settings, rig_);
  }

  void check(const Scenario& scenario) const override {
    check_integrator(scenario, scenario.plant(), "plant.", {});
  }

  [[nodiscard]] Results run(const Scenario& scenario, ExperimentContext& context) const override {
    ArmRig rig{rig_, scenario, context};
    const std::vector<Pose> poses = poses_to_edge(rig.model());
    const GravityCompensation carried{gravity_, rig.model()};
    const GravityCompensation loose{{.share = 0.0}, rig.model()};
    std::vector<Drift> with;
    std::vector<Drift> without;
    for (const Pose& pose : poses) {
      with.push_back(let_go(rig, pose, carried));
      without.push_back(let_go(rig, pose, loose));
    }
    (void)rig.move_to(JointVector::Zero(), 1.0, 0.2);
    if (context.figures != nullptr) draw(with, without, *context.figures);
    return results_of(poses, with, without, rig.fault());
  }

 private:
  [[nodiscard]] std::vector<Pose> poses_to_edge(const ArmModel& model) const {
    std::vector<Pose> poses{{}};
    for (int ray = 0; ray < directions_; ++ray) {
      const double angle = 2.0 * std::numbers::pi * ray / directions_;
      const Vector3 direction{0.0, std::cos(angle), std::sin(angle)};
      const double edge = edge_share_ * edge_along(model, direction);
      for (int step = 1; step <= steps_; ++step) {
        const double distance = edge * step / steps_;
        poses.push_back({.q = inverse_kinematics(model, distance * direction).q,
                         .angle_rad = angle,
                         .distance_m = distance});
      }
    }
    return poses;
  }

  [[nodiscard]] Drift let_go(ArmRig& rig, const Pose& pose, const GravityCompensation& law) const {
    Drift drift;
    const auto samples = static_cast<std::size_t>(seconds_ * rig_.rate_Hz) + 2;
    drift.course.reserve(samples);
    if (rig.move_to(pose.q, 0.8, 0.3) != ArmRig::Ending::time_over) return drift;
    const ArmModel& model = rig.model();
    const Vector3 start = tool_position(model, rig.q());
    const double limit_m = 1e-3 * drift_limit_mm_;
    (void)rig.run(seconds_, [&](const ArmTurn& turn) noexcept -> std::optional<JointVector> {
      drift.end_m = (tool_position(model, turn.q) - start).norm();
      const bool room = drift.course.size() < drift.course.capacity();
      if (room) drift.course.emplace_back(turn.t_s, 1e3 * drift.end_m);
      if (drift.end_m > limit_m) return std::nullopt;
      return law.step(turn.q);
    });
    return drift;
  }

  [[nodiscard]] Results results_of(const std::vector<Pose>& poses,
                                   const std::vector<Drift>& with,
                                   const std::vector<Drift>& without,
                                   Fault fault) const {
    const auto worst = std::max_element(with.begin(), with.end(), less);
    const Pose& worst_pose = poses[static_cast<std::size_t>(worst - with.begin())];
    const auto fallen = std::count_if(without.begin(), without.end(), [&](const Drift& drift) {
      return drift.end_m > 1e-3 * drift_limit_mm_;
    });
    return {{"drift_mm", 1e3 * worst->end_m, "mm"},
            {"drift_rms_mm", rms_mm(with), "mm"},
            {"worst_y_mm", 1e3 * worst_pose.distance_m * std::cos(worst_pose.angle_rad), "mm"},
            {"worst_z_mm", 1e3 * worst_pose.distance_m * std::sin(worst_pose.angle_rad), "mm"},
            {"drift_without_mm",
             1e3 * std::max_element(without.begin(), without.end(), less)->end_m, "mm"},
            {"drift_without_rms_mm", rms_mm(without), "mm"},
            {"fallen_without", static_cast<double>(fallen), "poses"},
            {"poses", static_cast<double>(poses.size()), "poses"},
            {"fault", static_cast<double>(fault), "number"}};
  }

  [[nodiscard]] static bool less(const Drift& a, const Drift& b) noexcept {
    return a.end_m < b.end_m;
  }

  [[nodiscard]] static double rms_mm(const std::vector<Drift>& drifts) {
    double sum = 0.0;
    for (const Drift& drift : drifts) {
      sum += drift.end_m * drift.end_m;
    }
    return 1e3 * std::sqrt(sum / static_cast<double>(drifts.size()));
  }

  static void draw(const std::vector<Drift>& with,
                   const std::vector<Drift>& without,
                   std::vector<Figure>& figures) {
    Figure over_time{.name = "drift",
                     .title = "Drift of the tool after it was let go at rest, every pose",
                     .x_label = "time (s)",
                     .y_label = "drift (mm)"};
    for (std::size_t i = 0; i < with.size(); ++i) {
      over_time.curves.push_back(
          {.label = i == 0 ? "without compensation" : "", .points = without[i].course});
    }
    for (std::size_t i = 0; i < with.size(); ++i) {
      over_time.curves.push_back(
          {.label = i == 0 ? "with compensation" : "", .points = with[i].course});
    }
    figures.push_back(std::move(over_time));
  }

  int directions_ = 8;
  int steps_ = 3;
  double edge_share_ = 0.97;
  double seconds_ = 2.0;
  double drift_limit_mm_ = 20.0;
  GravityCompensation::Config gravity_{};
  ArmRig::Config rig_{};
};

}  // namespace

extern const ExperimentKind gravity_experiment;
const ExperimentKind gravity_experiment{
    .name = "gravity",
    .text = "drift of an arm let go at rest, with and without gravity compensation, home to edge",
    .hardware = true,
    .make = []() -> std::unique_ptr<Experiment> { return std::make_unique<GravityExperiment>(); },
};

}  // namespace teleop
