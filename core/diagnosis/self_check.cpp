#include "core/diagnosis/self_check.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "core/diagnosis/leftover.hpp"
#include "core/diagnosis/replicate.hpp"

namespace teleop {
namespace {

constexpr std::uint64_t kReplicas = 2;
constexpr double kStandsOut = 3.0;  // standard errors

}  // namespace

SelfCheck self_check(const Likelihood& likelihood, const Explanation& explanation) {
  const Fit& known = explanation.fit;
  const Eigen::VectorXd truth = coordinates_of(known.model, known.free);
  SelfCheck check{.bias = Eigen::VectorXd::Zero(truth.size())};
  for (std::uint64_t seed = 1; seed <= kReplicas; ++seed) {
    const DiagnosisCase made = replicate(likelihood, known.model, explanation.noise, seed);
    Likelihood other{made, likelihood.arm(), likelihood.threads()};
    other.set_noise(explanation.noise);
    const Fit again = fit(other, base_columns(other, known.model), known.model, {.iterations = 6});
    check.bias +=
        (coordinates_of(again.model, again.free) - truth) / static_cast<double>(kReplicas);
    const Leftovers left = leftovers(other, again);
    check.leftover = std::max(check.leftover, left.all.front().gain);
  }
  return check;
}

void widen(SearchResult& found, const SelfCheck& check) {
  Eigen::Index next = 0;
  for (NamedEffect& named : found.effects) {
    for (double& deviation : named.deviations) {
      const double bias = check.bias[next++];
      const double known = deviation / std::sqrt(static_cast<double>(kReplicas));
      if (std::abs(bias) < kStandsOut * known) continue;
      deviation = std::hypot(deviation, bias);
    }
  }
}

}  // namespace teleop
