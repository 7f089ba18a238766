#include "core/diagnosis/replicate.hpp"

#include <cmath>

#include "core/diagnosis/exact_reading.hpp"
#include "core/diagnosis/parallel.hpp"
#include "core/diagnosis/predictor.hpp"
#include "core/effects/vocabulary.hpp"
#include "core/math/random.hpp"
#include "core/model/dynamics.hpp"
#include "core/simulation/plant.hpp"

namespace teleop {
namespace {

JointVector normal(Random& random) {
  const double a = random.normal();
  const double b = random.normal();
  const double c = random.normal();
  return {a, b, c};
}

JointVector rounded(const JointVector& values, const JointVector& step) {
  JointVector result = values;
  for (Eigen::Index i = 0; i < values.size(); ++i) {
    if (step[i] > 0.0) result[i] = std::round(values[i] / step[i]) * step[i];
  }
  return result;
}

/// White and coloured torque of a NoiseModel, and the part of the readings' noise that counting
/// does not make.
class Shaking {
 public:
  Shaking(const NoiseModel& noise, const JointVector& resolution, double period_s, Random& random)
      : noise_{&noise},
        memory_{(-period_s * noise.time_constant.cwiseInverse()).array().exp().matrix()},
        reading_{
            (noise.reading.cwiseAbs2() - resolution.cwiseAbs2() / 12.0).cwiseMax(0.0).cwiseSqrt()},
        coloured_{noise.coloured.cwiseProduct(normal(random))} {}

  [[nodiscard]] JointVector torque(Random& random) {
    const JointVector now = coloured_ + noise_->white.cwiseProduct(normal(random));
    const JointVector fresh = (JointVector::Ones() - memory_.cwiseAbs2()).cwiseSqrt();
    coloured_ = memory_.cwiseProduct(coloured_) +
                fresh.cwiseProduct(noise_->coloured).cwiseProduct(normal(random));
    return now;
  }

  [[nodiscard]] JointVector reading(Random& random) const {
    return reading_.cwiseProduct(normal(random));
  }

 private:
  const NoiseModel* noise_;
  JointVector memory_;
  JointVector reading_;
  JointVector coloured_;
};

Recording replicate_run(const Recording& run,
                        const DiagnosisCase& data,
                        const PredictorModel& model,
                        Shaking shaking,
                        Random random) {
  const ArmModel& arm = model.arm;
  const PlantTerms& terms = model.terms;
  constexpr double kRate = 15.0;   // rad/s, of the law that keeps the arm near
  constexpr double kSmooth = 0.1;  // of the speed's filter, a sample
  const Duration sample = true_period(data.period_s, terms);
  const JointVector q0 = drive_angle(terms, run.q.front());
  const JointVector qd0 = start_speed(run, data.period_s);
  Plant plant{arm, {.terms = terms, .stops = false, .max_step = sample, .q = q0, .qd = qd0}};
  ExactReading reading{terms, q0, qd0};
  const JointVector inertia = mass_matrix(arm, run.q[run.rows() / 2]).diagonal();
  Recording made = run;
  JointVector apart_before = JointVector::Zero();
  JointVector speed = JointVector::Zero();
  for (std::size_t k = 0; k < run.rows(); ++k) {
    made.q[k] = rounded(reading.of(plant.drive_q()) + shaking.reading(random), data.resolution);
    const JointVector apart = run.q[k] - made.q[k];
    speed += kSmooth * ((apart - apart_before) / data.period_s - speed);
    apart_before = apart;
    const JointVector hold = inertia.cwiseProduct(kRate * kRate * apart + 1.4 * kRate * speed);
    made.tau[k] = rounded(run.tau[k] + hold, JointVector{JointVector::Constant(data.command_step)});
    const JointVector shake = shaking.torque(random);
    plant.set_disturbance(run.contact.empty() ? shake : JointVector{shake - run.contact[k]});
    plant.set_torque(made.tau[k]);
    plant.advance(sample, reading.observer());
  }
  return made;
}

}  // namespace

DiagnosisCase replicate(const Likelihood& likelihood,
                        const MachineModel& model,
                        const NoiseModel& noise,
                        std::uint64_t seed) {
  const PlantTerms terms = terms_of(model.effects);
  const ArmModel arm = likelihood.prior().arm(model.base);
  DiagnosisCase made = likelihood.data();
  for_each_index(made.runs.size(), likelihood.threads(), [&](std::size_t run) {
    Random random{seed + 1000 * run};
    const Shaking shaking{noise, made.resolution, made.period_s, random};
    made.runs[run] =
        replicate_run(likelihood.data().runs[run], made, {arm, terms}, shaking, random);
  });
  return made;
}

}  // namespace teleop
