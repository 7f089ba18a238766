#pragma once

#include <atomic>
#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/diagnosis/fit.hpp"
#include "core/diagnosis/likelihood.hpp"
#include "core/diagnosis/screen.hpp"

namespace teleop {

/// A model fitted to recordings together with the noise that goes with it.
struct Explanation {
  Fit fit{};
  NoiseModel noise{};
  double deviance = 0.0;  ///< −2 log of likelihood and prior
  double left_out = 0.0;  ///< the same with every run predicted from the others

  /// Deviance and what its parameters cost: the less the better.
  [[nodiscard]] double score() const;
};

/// One effect of an explanation and what else could stand in its place.
struct NamedEffect {
  struct Rival {
    EffectSpec effect{};
    double behind = 0.0;  ///< by which the score of the explanation with it is worse
  };
  EffectSpec effect{};
  std::vector<FreeParameter> free{};
  Eigen::VectorXd deviations{};  ///< of `free`, in their searched coordinates
  double gain = 0.0;             ///< by which the score is worse without it or anything for it
  std::vector<Rival> rivals{};   ///< the nearest first
};

struct SearchResult {
  Explanation nominal{};
  Explanation best{};
  std::vector<NamedEffect> effects{};
  bool unfinished = false;  ///< somebody stopped the search: effects or rivals may be missing
};

struct SearchOptions {
  std::size_t most_effects = 3;
  double least_gain = 15.0;  ///< in score, for another effect
  std::function<void(const std::string&)> progress{};
  std::function<void(double)> advanced{};   ///< share of the work that is done, about
  const std::atomic<bool>* stop = nullptr;  ///< set by whoever wants what is known by then
};

/// Looks for the fewest effects that explain the recordings: the vocabulary is screened, the most
/// promising candidates are fitted with the noise that each leaves, the best joins the model, and
/// so on while it pays; then each effect is tried against its rivals in the presence of the others.
[[nodiscard]] SearchResult search(Likelihood& likelihood, const SearchOptions& options);

}  // namespace teleop
