#include "scenarios/concealed/run.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>

#include "core/math/random.hpp"
#include "scenarios/concealed/plant.hpp"

namespace teleop::concealed {
namespace {

using std::numbers::pi;

Eigen::Index at(std::size_t i) { return static_cast<Eigen::Index>(i); }

/// Streams of one run that do not disturb each other.
enum class Stream : std::uint64_t { white = 1, coloured, narrow, encoder, late, instants };
Random stream(std::uint64_t seed, Stream which) {
  Random mixer{seed + 0x51ed2701U * static_cast<std::uint64_t>(which)};
  return Random{mixer.bits()};
}

/// Torques that are held for half a sample each: the log's grid is not the noise's.
class Shaking {
 public:
  Shaking(const Disturbance& levels, std::uint64_t seed, double half_period)
      : levels_{levels},
        white_{stream(seed, Stream::white)},
        coloured_{stream(seed, Stream::coloured)},
        narrow_{stream(seed, Stream::narrow)},
        half_{half_period} {
    for (Eigen::Index i = 0; i < slow_.size(); ++i) {
      slow_[i] = levels_.coloured_Nm[i] * coloured_.normal();
    }
  }

  JointVector next() {
    JointVector torque;
    const double turn = 2.0 * pi * levels_.narrow_Hz * half_;
    const double kept = std::exp(-0.05 * turn);
    for (Eigen::Index i = 0; i < slow_.size(); ++i) {
      const double phi = std::exp(-half_ / levels_.coloured_time_s[i]);
      slow_[i] =
          phi * slow_[i] + levels_.coloured_Nm[i] * std::sqrt(1.0 - phi * phi) * coloured_.normal();
      torque[i] = slow_[i] + std::numbers::sqrt2 * levels_.white_Nm[i] * white_.normal();
      if (levels_.narrow_Nm[i] == 0.0) continue;
      const double drive = levels_.narrow_Nm[i] * std::sqrt(1.0 - kept * kept);
      const double x = band_x_[i];
      const double y = band_y_[i];
      band_x_[i] = kept * (std::cos(turn) * x - std::sin(turn) * y) + drive * narrow_.normal();
      band_y_[i] = kept * (std::sin(turn) * x + std::cos(turn) * y) + drive * narrow_.normal();
      torque[i] += band_x_[i];
    }
    return torque;
  }

 private:
  Disturbance levels_;
  Random white_;
  Random coloured_;
  Random narrow_;
  double half_;
  JointVector slow_ = JointVector::Zero();
  JointVector band_x_ = JointVector::Zero();
  JointVector band_y_ = JointVector::Zero();
};

class Controller {
 public:
  Controller(const RunPlan& plan, const ArmModel& nominal)
      : plan_{plan}, nominal_{nominal.lumped()}, speed_{plan.excitation.rate.front()} {}

  JointVector step(std::size_t row, const JointVector& y) {
    const Excitation& wish = plan_.excitation;
    const JointVector weight{0.0, nominal_.N2 * std::cos(y[1]), nominal_.N3 * std::sin(y[2])};
    JointVector u;
    for (std::size_t i = 0; i < kJoints; ++i) {
      const auto k = at(i);
      const AxisController& axis = plan_.control[i];
      if (row > 0) {
        const double share = 1.0 - std::exp(-2.0 * pi * axis.bandwidth_Hz * kStatedPeriod);
        speed_[k] += share * ((y[k] - before_[k]) / kStatedPeriod - speed_[k]);
      }
      const double torque = axis.stiffness * (wish.path[row][k] - y[k]) +
                            axis.damping * (wish.rate[row][k] - speed_[k]) +
                            axis.inertia * wish.acceleration[row][k] + weight[k] +
                            wish.torque[row][k] +
                            axis.friction_feed_forward * std::tanh(wish.rate[row][k] / 0.05);
      u[k] = std::clamp(torque, -kLargest_Nm, kLargest_Nm);
      u[k] = kCommandStep_Nm * std::round(u[k] / kCommandStep_Nm);
    }
    before_ = y;
    return u;
  }

 private:
  static constexpr double kLargest_Nm = 0.6;
  const RunPlan& plan_;
  ArmModel::Lumped nominal_;
  JointVector speed_;
  JointVector before_ = JointVector::Zero();
};

/// The amplifier's own measurement of its current, as torque.
class CurrentLog {
 public:
  explicit CurrentLog(const PlantLaw& law)
      : on_{law.logs_current}, kept_{std::exp(-1e-3 * law.time_ratio / law.current_lag)} {}

  JointVector entry(const JointVector& u) {
    if (!on_) return u;
    if (first_) current_ = u;
    first_ = false;
    const JointVector measured = current_;
    current_ = u + kept_ * (current_ - u);
    return (measured / kCommandStep_Nm).array().round() * kCommandStep_Nm;
  }

 private:
  bool on_;
  bool first_ = true;
  double kept_;
  JointVector current_ = JointVector::Zero();
};

}  // namespace

bool Run::usable(const Run& calm) const noexcept {
  const JointVector farthest{0.75, 0.65, 0.6};
  const JointVector roughest = 3.0 * calm.chatter + JointVector::Constant(1e-3);
  return (largest_departure.array() < farthest.array()).all() && largest_speed < 8.0 &&
         (chatter.array() < roughest.array()).all();
}

JointVector count_rad(const ArmModel& arm) {
  const auto& counts = arm.parameters().encoder_counts_per_rev;
  return {2.0 * pi / counts[0], 2.0 * pi / counts[1], 2.0 * pi / counts[2]};
}

PlantLaw law_of(const Device& device, std::size_t run) {
  std::vector<Effect> present;
  std::copy_if(device.effects.begin(), device.effects.end(), std::back_inserter(present),
               [&](const Effect& effect) { return !effect.training_only || run + 1 < kRuns; });
  return plant_law(device.arm, present, stream(device.runs[run].seed, Stream::instants).bits());
}

double slipped_counts(const ReadingLaw& law, double t) noexcept {
  const auto made = std::upper_bound(law.slips.begin(), law.slips.end(), t) - law.slips.begin();
  return law.slip_counts * static_cast<double>(made);
}

Run simulate(const Device& device, std::size_t index, int substeps) {
  const RunPlan& plan = device.runs[index];
  const PlantLaw law = law_of(device, index);
  Plant plant{law, plan.q, plan.v, substeps};
  Shaking shaking{device.disturbance, plan.seed, plant.period() / 2.0};
  Random encoder = stream(plan.seed, Stream::encoder);
  Random lateness = stream(plan.seed, Stream::late);
  Controller controller{plan, device.nominal};
  CurrentLog log{law};
  const JointVector count = count_rad(device.nominal);
  const ReadingLaw& stamps = law.axes[0].reading;

  Run run{.excitation = plan.excitation.text};
  run.counts.reserve(kRows);
  run.logged.reserve(kRows);
  run.applied.reserve(kRows);
  JointVector u = JointVector::Zero();
  for (std::size_t k = 0; k < kRows; ++k) {
    if (stamps.jitter > 0.0) {
      const bool loaded = u.cwiseAbs().maxCoeff() > stamps.jitter_from;
      const double late = stamps.jitter * std::abs(lateness.normal());
      run.late.push_back(loaded ? std::min(late, plant.period()) : 0.0);
    }
    const JointVector exact = plant.reading(run.late.empty() ? 0.0 : run.late.back());
    JointVector y;
    std::array<std::int32_t, kJoints> counts{};
    for (std::size_t i = 0; i < kJoints; ++i) {
      const double noise = device.disturbance.encoder_noise_counts * encoder.normal();
      const double slip = slipped_counts(law.axes[i].reading, plant.time());
      counts[i] =
          static_cast<std::int32_t>(std::lround(exact[at(i)] / count[at(i)] + noise + slip));
      y[at(i)] = counts[i] * count[at(i)];
    }
    const JointVector before = u;
    u = controller.step(k, y);
    if (k > 0) run.chatter += (u - before).cwiseAbs2() / static_cast<double>(kRows);
    run.counts.push_back(counts);
    run.applied.push_back(u);
    run.logged.push_back(log.entry(u));
    plant.command(u);
    plant.advance_half(shaking.next());
    plant.advance_half(shaking.next());
    run.largest_departure =
        run.largest_departure.cwiseMax((plant.motion().q - middle_posture()).cwiseAbs());
    run.largest_speed = std::max(run.largest_speed, plant.motion().v.cwiseAbs().maxCoeff());
  }
  run.chatter = run.chatter.cwiseSqrt();
  return run;
}

}  // namespace teleop::concealed
