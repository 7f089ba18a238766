#include "core/diagnosis/free_run.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Core>

#include "core/diagnosis/parallel.hpp"
#include "core/diagnosis/predictor.hpp"
#include "core/diagnosis/replicate.hpp"
#include "core/diagnosis/tether_covariance.hpp"
#include "core/effects/vocabulary.hpp"
#include "core/model/dynamics.hpp"

namespace teleop {
namespace {

constexpr double kAlone_s = 0.25;
constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

/// By which the weight of the arm holds a joint where it is, or drives it away.
JointMatrix weight_stiffness(const ArmModel& arm, const JointVector& q) {
  constexpr double kStep = 1e-4;  // rad
  JointMatrix stiffness;
  for (Eigen::Index i = 0; i < 3; ++i) {
    const JointVector step = kStep * JointVector::Unit(i);
    stiffness.col(i) =
        (gravity_torque(arm, q + step) - gravity_torque(arm, q - step)) / (2.0 * kStep);
  }
  return stiffness;
}

/// Σ e² of the true model that is left alone on recordings which it made itself.
JointVector replica_noise(const Likelihood& likelihood,
                          const Explanation& best,
                          std::size_t alone) {
  constexpr std::uint64_t kSeed = 1;
  const DiagnosisCase made = replicate(likelihood, best.fit.model, best.noise, kSeed);
  const PlantTerms terms = terms_of(best.fit.model.effects);
  const ArmModel arm = likelihood.prior().arm(best.fit.model.base);
  PredictorModel left{arm, terms};
  left.free_rows = alone;
  std::vector<JointVector> sums(likelihood.runs(), JointVector::Zero());
  for_each_index(likelihood.runs(), likelihood.threads(), [&](std::size_t run) {
    const Prediction told = predict(left, made.runs[run], made.period_s, likelihood.tether(run));
    for (std::size_t k = 0; k < told.innovations.size(); ++k) {
      if (k / alone % 2 == 1) sums[run] += told.innovations[k].cwiseAbs2();
    }
  });
  JointVector total = JointVector::Zero();
  for (const JointVector& each : sums) {
    total += each;
  }
  return total;
}

/// What one run adds up while models are alone.
struct Sums {
  JointVector motion = JointVector::Zero();
  JointVector nominal = JointVector::Zero();
  JointVector corrected = JointVector::Zero();
  JointVector noise = JointVector::Zero();
};

/// One run under both models, and what noise makes of it to first order.
Sums leave_alone(const Likelihood& likelihood,
                 const SearchResult& found,
                 std::size_t alone,
                 FreeRun::Trace& trace) {
  const std::size_t run = trace.run;
  const double period_s = likelihood.data().period_s;
  const Recording& recording = likelihood.data().runs[run];
  const auto errors_of = [&](const Fit& fit) {
    const MachineModel model = fit.left_out_model(run);
    const PlantTerms terms = terms_of(model.effects);
    const ArmModel arm = likelihood.prior().arm(model.base);
    PredictorModel left{arm, terms};
    left.free_rows = alone;
    return predict(left, recording, period_s, likelihood.tether(run)).innovations;
  };
  trace.nominal = errors_of(found.nominal.fit);
  trace.corrected = errors_of(found.best.fit);
  trace.deviation.assign(recording.rows(), JointVector::Constant(kNone));
  const std::vector<JointMatrix> mobility = mobilities(likelihood.arm(), recording);
  TetherCovariance known{likelihood.noise(), period_s};
  JointVector start = JointVector::Zero();
  Sums sums;
  for (std::size_t k = 0; k < recording.rows(); ++k) {
    if (k / alone % 2 == 0) {
      known.update();
      known.pass(mobility[k]);
      if ((k + 1) / alone % 2 == 1) known.forget_disturbance();
      start = recording.q[k];
      trace.nominal[k].setConstant(kNone);
      trace.corrected[k].setConstant(kNone);
      continue;
    }
    const JointVector variance = known.of_innovation().diagonal();
    known.pass(mobility[k], weight_stiffness(likelihood.arm(), recording.q[k]));
    trace.deviation[k] = variance.cwiseSqrt();
    sums.noise += variance;
    sums.motion += (recording.q[k] - start).cwiseAbs2();
    sums.nominal += trace.nominal[k].cwiseAbs2();
    sums.corrected += trace.corrected[k].cwiseAbs2();
  }
  return sums;
}

}  // namespace

FreeRun free_run(const Likelihood& likelihood, const SearchResult& found) {
  const auto alone = static_cast<std::size_t>(std::lround(kAlone_s / likelihood.data().period_s));
  FreeRun result{.motion_s = kAlone_s};
  result.traces.resize(likelihood.runs());
  std::vector<Sums> sums(likelihood.runs());
  for_each_index(likelihood.runs(), likelihood.threads(), [&](std::size_t run) {
    result.traces[run].run = run;
    sums[run] = leave_alone(likelihood, found, alone, result.traces[run]);
  });
  Sums total;
  for (const Sums& each : sums) {
    total.motion += each.motion;
    total.nominal += each.nominal;
    total.corrected += each.corrected;
    total.noise += each.noise;
  }
  const auto share = [&](const JointVector& of) {
    return JointVector{of.cwiseQuotient(total.motion.cwiseMax(1e-300)).cwiseSqrt()};
  };
  // Friction holds what noise would move: a replica knows, the linear model does not.
  const JointVector replica = replica_noise(likelihood, found.best, alone);
  const JointVector calmer = replica.cwiseQuotient(total.noise.cwiseMax(1e-300)).cwiseSqrt();
  for (FreeRun::Trace& trace : result.traces) {
    for (JointVector& deviation : trace.deviation) {
      deviation = deviation.cwiseProduct(calmer).eval();
    }
  }
  total.noise = replica;
  result.nominal = share(total.nominal);
  result.corrected = share(total.corrected);
  result.noise = share(total.noise);
  return result;
}

}  // namespace teleop
