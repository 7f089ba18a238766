#include "core/diagnosis/predictor.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>

#include <Eigen/LU>

#include "core/diagnosis/drive_tether.hpp"
#include "core/diagnosis/exact_reading.hpp"
#include "core/diagnosis/late_axis.hpp"
#include "core/model/dynamics.hpp"
#include "core/simulation/plant.hpp"

namespace teleop {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

/// Gains of the axes whose transmission gives way, at the middle posture of the run.
std::array<DriveGains, kJoints> drive_gains(const PredictorModel& model,
                                            const Recording& run,
                                            double period_s,
                                            const Tether& tether) {
  std::array<DriveGains, kJoints> gains{};
  const JointMatrix W = mass_matrix(model.arm, run.q[run.rows() / 2]).inverse();
  const NoiseModel& noise = tether.noise();
  for (std::size_t i = 0; i < kJoints; ++i) {
    const auto axis = static_cast<Eigen::Index>(i);
    const Transmission& transmission = model.terms.transmission[i];
    const AxisNoise own{.white = noise.white[axis],
                        .coloured = noise.coloured[axis],
                        .memory = tether.memory()[axis],
                        .reading = noise.reading[axis]};
    if (transmission.kind == Transmission::Kind::compliant) {
      const double link = 1.0 / W(axis, axis) - transmission.drive_inertia;
      gains[i] = elastic_gains(transmission, std::max(link, 1e-2 / W(axis, axis)), period_s, own);
    } else if (transmission.kind == Transmission::Kind::play) {
      gains[i] = free_gains(transmission, period_s, own);
    }
  }
  return gains;
}

/// 1/s: what is faster cannot be told from what is rigid.
constexpr double kFastest = 1500.0;

bool has_rigid_wall(const PredictorModel& model, const Recording& run) {
  const JointMatrix W = mass_matrix(model.arm, run.q[run.rows() / 2]).inverse();
  return std::any_of(model.terms.walls.begin(), model.terms.walls.end(),
                     [&](const JointWall& wall) {
                       const auto axis = static_cast<Eigen::Index>(wall.axis);
                       return wall.stiffness * W(axis, axis) > kFastest * kFastest ||
                              wall.damping * W(axis, axis) > kFastest;
                     });
}

using LateAxes = std::array<LateAxis, kJoints>;

/// The axes whose readings come late, at the middle posture of the run.
LateAxes late_axes(const PredictorModel& model,
                   const Recording& run,
                   double period_s,
                   const Tether& tether) {
  const JointMatrix W = mass_matrix(model.arm, run.q[run.rows() / 2]).inverse();
  LateAxes late;
  for (std::size_t i = 0; i < kJoints; ++i) {
    const auto axis = static_cast<Eigen::Index>(i);
    if (model.terms.sensing[i].delay <= 0.0) continue;
    late.at(i) = LateAxis{{.delay_s = model.terms.sensing[i].delay,
                           .period_s = period_s,
                           .mobility = W(axis, axis),
                           .memory = tether.memory()[axis]}};
  }
  return late;
}

JointVector pending(const LateAxes& late) {
  return {late[0].pending(), late[1].pending(), late[2].pending()};
}

/// Moves the plant towards the reading; returns what the disturbances become more, N m.
JointVector correct(Plant& plant,
                    const Tether::Step& step,
                    const std::array<DriveGains, kJoints>& drives,
                    LateAxes& late,
                    const JointVector& e) {
  Plant::Shift shift{.q = step.position * e, .qd = step.velocity * e};
  JointVector d = step.disturbance * e;
  const SlidingModes& modes = plant.sliding();
  for (std::size_t i = 0; i < kJoints; ++i) {
    const auto axis = static_cast<Eigen::Index>(i);
    if (plant.is_split(i)) {
      shift.q[axis] = drives[i].q * e[axis];
      shift.qd[axis] = drives[i].qd * e[axis];
      shift.m[axis] = drives[i].m * e[axis];
      shift.md[axis] = drives[i].md * e[axis];
      d[axis] = drives[i].d * e[axis];
    } else if (late[i].is_late()) {
      const LateAxis::State now = late[i].take({.q = step.position(axis, axis) * e[axis],
                                                .v = step.velocity(axis, axis) * e[axis],
                                                .d = step.disturbance(axis, axis) * e[axis]});
      shift.q[axis] = now.q;
      shift.qd[axis] = now.v;
      d[axis] = now.d;
    }
    // Friction holds the joint: it is at rest, whatever the noise of the readings.
    if (modes[i] == Sliding::stuck) {
      shift.md[axis] = 0.0;
      if (!plant.is_split(i)) shift.qd[axis] = 0.0;
    }
  }
  plant.shift(shift);
  return d;
}

}  // namespace

bool gives_way(const PlantTerms& terms) {
  return std::any_of(
      terms.transmission.begin(), terms.transmission.end(),
      [](const Transmission& each) { return each.kind != Transmission::Kind::rigid; });
}

Prediction predict(const PredictorModel& model,
                   const Recording& run,
                   double period_s,
                   const Tether& tether,
                   std::vector<PredictedState>* states) {
  const PlantTerms& terms = model.terms;
  const JointVector q0 = drive_angle(terms, run.q.front());
  const JointVector qd0 = start_speed(run, period_s);
  Plant plant{model.arm,
              {.terms = terms,
               .stops = false,
               .max_step = true_period(period_s, terms) / model.steps,
               .q = q0,
               .qd = qd0}};
  ExactReading reading{terms, q0, qd0};
  if (plant.fastest_rate() > kFastest || has_rigid_wall(model, run)) {
    return {.innovations = std::vector(run.rows(), JointVector{JointVector::Constant(kNone)})};
  }
  const Duration sample = true_period(period_s, terms);
  Prediction result;
  result.innovations.reserve(run.rows());
  const bool splits = gives_way(terms);
  if (splits) result.apart.assign(run.rows(), JointVector::Zero());
  if (states != nullptr) states->clear();
  const std::array<DriveGains, kJoints> drives = drive_gains(model, run, period_s, tether);
  LateAxes late = late_axes(model, run, period_s, tether);
  JointVector d = JointVector::Zero();
  for (std::size_t k = 0; k < run.rows(); ++k) {
    const Tether::Step& step = tether.steps()[k];
    const JointVector e = run.q[k] - reading.of(plant.drive_q()) - pending(late);
    constexpr double kLost = 10.0;      // rad: the model runs away from the recording
    constexpr std::uint64_t kBusy = 4;  // events a sample, on average
    const bool rattles = plant.events() > 1000 + kBusy * k;
    if (!(e.cwiseAbs().maxCoeff() < kLost) || rattles) {
      result.innovations.resize(run.rows(), JointVector{JointVector::Constant(kNone)});
      break;
    }
    result.innovations.push_back(e);
    for (std::size_t i = 0; splits && i < kJoints; ++i) {
      if (plant.is_split(i)) result.apart[k][static_cast<Eigen::Index>(i)] = drives[i].deviation;
    }
    if (states != nullptr) states->push_back({plant.drive_q(), plant.drive_qd(), d});
    const bool held = model.free_rows == 0 || k / model.free_rows % 2 == 0;
    d = held ? JointVector{d + correct(plant, step, drives, late, e)} : JointVector::Zero();
    const JointVector extra = run.contact.empty() ? d : JointVector{d - run.contact[k]};
    plant.set_disturbance(extra);
    plant.set_torque(run.tau[k]);
    d = tether.memory().cwiseProduct(d);
    plant.advance(sample, reading.observer());
  }
  return result;
}

}  // namespace teleop
