#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/diagnosis/likelihood.hpp"
#include "core/diagnosis/search.hpp"
#include "core/effects/plant_spec.hpp"
#include "core/identification/probe_motion.hpp"

namespace teleop {

/// What a motion of the arm would tell between the leading explanation and the rival that it leaves
/// nearest.
struct ExpectedEvidence {
  const ProbeMotion* motion = nullptr;
  std::string rival{};     ///< the one that is told apart least, in words
  double log_bayes = 0.0;  ///< expected, at least: the other may fit the new recording alone
};

/// The experiment to make next.
struct NextExperiment {
  std::vector<ExpectedEvidence> motions{};  ///< the most telling first
  bool ties = false;                        ///< there are rivals to be told apart
  std::string text{};                       ///< for the answer
};

/// Simulates every probe motion with the leading explanation and without noise, fits the nearest
/// rivals to the recording that it would give, and sums up what they cannot explain,
///
///     log Bayes factor ≥ ½ min Σ |w|²,
///
/// with the innovations w whitened by the noise of the recordings at hand; then the other way
/// round. Where there is no rival, each effect is held against its absence: what shows it best
/// measures it best. Where something is left over that nobody can simulate, repetition is advised.
[[nodiscard]] NextExperiment next_experiment(const Likelihood& likelihood,
                                             const SearchResult& found,
                                             const std::string& left_over);

/// The scenario that plays the first motion on the arm and records it, as `teleop run` reads it.
/// @param plant that it is simulated on, unless a device is named: arm and effects
[[nodiscard]] std::string scenario_of(const NextExperiment& next,
                                      const PlantSpec& plant,
                                      const std::string& log);

}  // namespace teleop
