#pragma once

#include <algorithm>
#include <cmath>

#include "core/identification/mechanical_form.hpp"
#include "core/math/random.hpp"

namespace teleop::testing {

/// A mechanism as arms have them: 20 to 120 g, a mode of 40 to 250 Hz, damped by 1 to 20 %.
inline MechanicalParameters random_mechanism(MechanicalForm form, Random& random) {
  const double mass = random.uniform(0.02, 0.12);
  const double m1 = mass * random.uniform(0.2, 0.8);
  const double reduced = m1 * (mass - m1) / mass;
  const double natural = 2.0 * 3.14159265358979 * random.uniform(40.0, 250.0);
  MechanicalParameters p{.m1_kg = m1,
                         .m2_kg = mass - m1,
                         .k_N_per_m = reduced * natural * natural,
                         .b_Ns_per_m = 2.0 * random.uniform(0.01, 0.2) * natural * reduced};
  if (form == MechanicalForm::b) p.k_t_N_per_m = random.uniform(2e3, 25e3);
  return p;
}

/// Frequencies of `count` lines, evenly spaced.
inline Eigen::VectorXd lines(double low_Hz, double high_Hz, Eigen::Index count) {
  return Eigen::VectorXd::LinSpaced(count, low_Hz, high_Hz);
}

/// The response of a mechanism as a measurement of white deviation would give it.
inline MeasuredResponse noisy_response(const MechanicalFamily& family,
                                       const MechanicalParameters& p,
                                       const Sampling& sampling,
                                       double relative_deviation,
                                       Random& random) {
  MeasuredResponse data{.frequency_Hz = lines(3.0, 500.0, 120), .value = {}, .deviation = {}};
  Linearised system = family(family.pack(p));
  system.derivatives.clear();
  data.value = sampled_response(system, sampling, data.frequency_Hz).value;
  data.deviation = relative_deviation * data.value.cwiseAbs();
  for (Eigen::Index i = 0; i < data.value.size(); ++i) {
    const double part = data.deviation(i) / std::sqrt(2.0);
    data.value(i) += std::complex<double>{part * random.normal(), part * random.normal()};
  }
  return data;
}

}  // namespace teleop::testing
