#include "core/diagnosis/search.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "core/base/error.hpp"
#include "core/effects/vocabulary.hpp"

namespace teleop {
namespace {

constexpr double kParameterCost = 11.0;  // about the logarithm of the number of samples
constexpr double kEffectCost = 10.0;     // twice that of the number of places to look at
constexpr std::size_t kFitted = 8;       // candidates of a screening that are fitted
constexpr std::size_t kWeighed = 4;      // and of these, those whose noise is fitted too
constexpr double kLeastShare = 0.1;      // of the best gain, for a candidate to be fitted
constexpr double kWorthAFit = 12.0;
constexpr double kNoiseHelps = 10.0;  // what refitting the noise may add to a small gain
constexpr double kBehind = 0.3;       // of the best gain, for a candidate to be weighed

std::string name_of(const EffectSpec& effect) {
  std::string name = effect.kind;
  if (effect.axis) name += fmt::format(" {}", *effect.axis + 1);
  return name;
}

/// Effects of one family do the same thing: on one axis they stand for each other.
bool same_family(const EffectSpec& a, const EffectSpec& b) {
  constexpr std::array<std::string_view, 3> kDry{"coulomb_friction", "stribeck_friction",
                                                 "presliding_hysteresis"};
  const auto dry = [&](const EffectSpec& effect) {
    return std::find(kDry.begin(), kDry.end(), effect.kind) != kDry.end();
  };
  return a.axis == b.axis && (a.kind == b.kind || (dry(a) && dry(b)));
}

/// The same effect apart from the values that a fit finds.
bool same_place(const EffectSpec& a, const EffectSpec& b) {
  if (a.kind != b.kind || a.axis != b.axis) return false;
  for (const EffectParameter& parameter : find_effect(a.kind).parameters) {
    if (parameter.role != EffectParameter::Role::given) continue;
    const std::string name{parameter.name};
    const auto one = a.parameters.find(name);
    const auto other = b.parameters.find(name);
    if (one == a.parameters.end() || other == b.parameters.end()) continue;
    if (one->second != other->second) return false;
  }
  return true;
}

/// A play of less than half a count does nothing but what counting does.
bool hides_in_counts(const EffectSpec& effect, const DiagnosisCase& data) {
  if (effect.kind != "backlash" || !effect.axis) return false;
  return effect.parameters.at("gap") <
         0.5 * data.resolution[static_cast<Eigen::Index>(*effect.axis)];
}

/// Whether one of the newest effect's sizes departs from none by more than chance.
bool stands_out(const Fit& fit) {
  constexpr double kErrors = 3.0;
  const std::size_t newest = fit.model.effects.size() - 1;
  const EffectSpec& effect = fit.model.effects[newest];
  const Eigen::VectorXd deviations = fit.deviations();
  bool has_size = false;
  for (std::size_t i = 0; i < fit.free.size(); ++i) {
    if (fit.free[i].effect != newest) continue;
    const auto& all = find_effect(effect.kind).parameters;
    const auto own = std::find_if(all.begin(), all.end(), [&](const EffectParameter& each) {
      return each.name == fit.free[i].name;
    });
    constexpr double kNone = std::numeric_limits<double>::infinity();
    const double neutral = own == all.end() ? kNone : own->neutral.value_or(kNone);
    if (std::isinf(neutral)) continue;
    has_size = true;
    const double value = effect.parameters.at(fit.free[i].name);
    const double unit = fit.free[i].logarithmic ? std::abs(value) : 1.0;
    const double deviation = unit * deviations[static_cast<Eigen::Index>(i)];
    if (std::abs(value - neutral) > kErrors * deviation) return true;
  }
  return !has_size;
}

/// The best trial of each place, best first.
std::vector<Candidate> promising(const std::vector<Candidate>& screened,
                                 const std::vector<EffectSpec>& present) {
  std::vector<Candidate> few;
  for (const Candidate& candidate : screened) {
    if (few.size() >= kFitted || candidate.gain < kWorthAFit) break;
    if (!few.empty() && candidate.gain < kLeastShare * few.front().gain) break;
    const auto is_there = [&](const EffectSpec& other) {
      return same_family(other, candidate.effect);
    };
    if (std::any_of(present.begin(), present.end(), is_there)) continue;
    const auto known = [&](const Candidate& other) {
      return same_place(other.effect, candidate.effect);
    };
    if (std::none_of(few.begin(), few.end(), known)) few.push_back(candidate);
  }
  return few;
}

class Search {
 public:
  Search(Likelihood& likelihood, const SearchOptions& options)
      : likelihood_{&likelihood},
        options_{&options},
        use_{use_of(likelihood.data(), likelihood.arm())} {}

  SearchResult run() {
    say("noise");
    NoiseModel start;
    start.reading = likelihood_->data().resolution.cwiseMax(1e-9) / std::sqrt(12.0);
    SearchResult result;
    result.nominal = weigh_anew({}, fit_noise(*likelihood_, {}, start));
    Explanation best = result.nominal;
    Explanation before;  // the last effect came
    std::vector<Explanation> rivals;
    while (best.fit.model.effects.size() < options_->most_effects && !stopped()) {
      std::vector<Explanation> next = extended(best);
      // What does not help to predict the other runs is not there.
      std::erase_if(next, [&](const Explanation& each) {
        return !stands_out(each.fit) || !(each.left_out < best.left_out - options_->least_gain) ||
               each.score() > best.score() - options_->least_gain;
      });
      if (next.empty()) break;
      joined_.push_back(best.score() - next.front().score());
      before = std::exchange(best, next.front());
      rivals = std::move(next);
      say(fmt::format("found {}", name_of(best.fit.model.effects.back())));
    }
    result.best = best;
    describe(result, before, rivals);
    result.unfinished = stopped();
    return result;
  }

 private:
  void say(const std::string& text) const {
    if (options_->progress) options_->progress(text);
  }

  [[nodiscard]] bool stopped() const noexcept {
    return options_->stop != nullptr && options_->stop->load(std::memory_order_relaxed);
  }

  /// A round of the search has come so far, 0 to 1. How many follow nobody knows: each is taken
  /// for half of what is left.
  void advance(double in_round) const {
    if (options_->advanced) options_->advanced(done_ + 0.5 * in_round * (1.0 - done_));
  }

  void end_round() {
    done_ += 0.5 * (1.0 - done_);
    advance(0.0);
  }

  /// Noise of a fitted model, and the fit under that noise. The likelihood keeps the noise.
  Explanation weigh(const MachineModel& fitted, const NoiseModel& noise) {
    likelihood_->set_noise(noise);
    Explanation result;
    result.noise = fit_noise(*likelihood_, fitted, noise);
    likelihood_->set_noise(result.noise);
    result.fit = fit(*likelihood_, base_columns(*likelihood_, fitted), fitted);
    result.deviance = likelihood_->deviance(result.fit.model, result.noise).sum() +
                      result.fit.model.base.squaredNorm();
    result.left_out = result.deviance - result.fit.chi2 + result.fit.left_out();
    return result;
  }

  /// The same of a model that was not fitted under this noise before.
  Explanation weigh_anew(const MachineModel& start, const NoiseModel& noise) {
    likelihood_->set_noise(noise);
    const BaseColumns base = base_columns(*likelihood_, start);
    return weigh(fit(*likelihood_, base, start, {.iterations = 8, .slopes = false}).model, noise);
  }

  /// The model with one effect more, in several ways, the best first. Nothing when the search is
  /// stopped on the way.
  std::vector<Explanation> extended(const Explanation& now) {
    likelihood_->set_noise(now.noise);
    constexpr double kScreened = 0.4;  // shares of a round, about
    constexpr double kAllFitted = 0.5;
    advance(0.0);
    say("screening");
    const std::vector<Candidate> few =
        promising(screen(*likelihood_, now.fit, use_), now.fit.model.effects);
    const BaseColumns base = base_columns(*likelihood_, now.fit.model);
    std::vector<Fit> fits;
    for (const Candidate& candidate : few) {
      if (stopped()) return {};
      advance(kScreened + (kAllFitted - kScreened) * static_cast<double>(fits.size()) /
                              static_cast<double>(few.size()));
      say(fmt::format("fitting {}", name_of(candidate.effect)));
      MachineModel model = now.fit.model;
      model.effects.push_back(candidate.effect);
      Fit trial = fit(*likelihood_, base, model, {.iterations = 5, .slopes = false});
      const bool seen = !hides_in_counts(trial.model.effects.back(), likelihood_->data());
      if (seen && std::isfinite(trial.chi2 + trial.volume)) fits.push_back(std::move(trial));
    }
    const auto cost = [](const Fit& each) {
      return each.chi2 + each.volume + kParameterCost * static_cast<double>(each.free.size());
    };
    std::stable_sort(fits.begin(), fits.end(),
                     [&](const Fit& a, const Fit& b) { return cost(a) < cost(b); });
    if (fits.size() > kWeighed) fits.resize(kWeighed);
    const double here = cost(now.fit) - kEffectCost;
    const double most = fits.empty() ? 0.0 : here - cost(fits.front());
    std::erase_if(fits, [&](const Fit& each) {
      const double gain = here - cost(each);
      return gain < options_->least_gain - kNoiseHelps || gain < kBehind * most;
    });
    std::vector<Explanation> next;
    for (const Fit& each : fits) {
      // The best of them is weighed even so: it is known by now.
      if (stopped() && !next.empty()) break;
      advance(kAllFitted + (1.0 - kAllFitted) * static_cast<double>(next.size()) /
                               static_cast<double>(fits.size()));
      say(fmt::format("weighing {}", name_of(each.model.effects.back())));
      Explanation weighed = weigh(each.model, now.noise);
      const bool seen = !hides_in_counts(weighed.fit.model.effects.back(), likelihood_->data());
      if (seen && std::isfinite(weighed.deviance)) next.push_back(std::move(weighed));
    }
    end_round();
    std::stable_sort(next.begin(), next.end(), [](const Explanation& a, const Explanation& b) {
      return a.score() < b.score();
    });
    return next;
  }

  /// Drops effects that say nothing beside those that came after them.
  /// @returns the explanations without each of those that stay
  std::vector<Explanation> prune(SearchResult& result, const Explanation& before_last) {
    std::vector<Explanation> rests;
    bool as_chosen = true;
    while (rests.size() < result.best.fit.model.effects.size()) {
      const bool last = rests.size() + 1 == result.best.fit.model.effects.size();
      Explanation rest = last && as_chosen ? before_last : without(result, rests.size());
      if (rest.score() < result.best.score() + options_->least_gain) {
        result.best = std::move(rest);
        rests.clear();
        as_chosen = false;
      } else {
        rests.push_back(std::move(rest));
      }
    }
    return rests;
  }

  /// What each effect is worth, its rivals and its parameters' uncertainty. The rivals of the last
  /// one are known from when it was chosen, unless the others have changed since.
  void describe(SearchResult& result,
                const Explanation& before_last,
                const std::vector<Explanation>& last_rivals) {
    const std::size_t chosen = result.best.fit.model.effects.size();
    if (chosen > 1 && stopped()) {
      for (std::size_t i = 0; i < chosen; ++i) {
        result.effects.push_back({.effect = result.best.fit.model.effects[i], .gain = joined_[i]});
      }
      return add_deviations(result);
    }
    const std::vector<Explanation> rests = prune(result, before_last);
    bool as_chosen = chosen == rests.size();
    for (std::size_t i = 0; i < rests.size(); ++i) {
      const bool known = as_chosen && i + 1 == chosen;
      const Explanation rest = as_chosen ? rests[i] : without(result, i);
      const std::vector<Explanation> rivals = known ? last_rivals : extended(rest);
      if (!rivals.empty() && rivals.front().score() < result.best.score() - 1.0) {
        result.best = in_place_of(i, result.best, rivals.front());
        as_chosen = false;
      }
      NamedEffect named{.effect = result.best.fit.model.effects[i],
                        .gain = rest.score() - result.best.score()};
      for (const Explanation& rival : rivals) {
        const EffectSpec& other = rival.fit.model.effects.back();
        if (same_place(other, named.effect)) continue;
        named.rivals.push_back({.effect = other, .behind = rival.score() - result.best.score()});
      }
      result.effects.push_back(std::move(named));
    }
    add_deviations(result);
  }

  void add_deviations(SearchResult& result) {
    likelihood_->set_noise(result.best.noise);
    const Eigen::VectorXd all = result.best.fit.deviations();
    for (std::size_t i = 0; i < result.effects.size(); ++i) {
      NamedEffect& named = result.effects[i];
      named.effect = result.best.fit.model.effects[i];
      std::vector<double> own;
      for (std::size_t j = 0; j < result.best.fit.free.size(); ++j) {
        if (result.best.fit.free[j].effect != i) continue;
        named.free.push_back(result.best.fit.free[j]);
        own.push_back(all[static_cast<Eigen::Index>(j)]);
      }
      named.deviations =
          Eigen::Map<const Eigen::VectorXd>{own.data(), static_cast<Eigen::Index>(own.size())};
    }
  }

  Explanation without(const SearchResult& found, std::size_t i) {
    MachineModel rest = found.best.fit.model;
    if (rest.effects.size() == 1) return found.nominal;
    say(fmt::format("without {}", name_of(rest.effects[i])));
    rest.effects.erase(rest.effects.begin() + static_cast<std::ptrdiff_t>(i));
    return weigh_anew(rest, found.best.noise);
  }

  /// The rival's newcomer, which came last, at the place of the one that it replaces.
  Explanation in_place_of(std::size_t i, const Explanation& best, const Explanation& rival) {
    MachineModel model = rival.fit.model;
    std::vector<EffectSpec>& order = model.effects;
    say(fmt::format("{} stands in for {}", name_of(order.back()),
                    name_of(best.fit.model.effects[i])));
    std::rotate(order.begin() + static_cast<std::ptrdiff_t>(i), order.end() - 1, order.end());
    return weigh(model, rival.noise);
  }

  Likelihood* likelihood_;
  const SearchOptions* options_;
  MachineUse use_;
  std::vector<double> joined_{};  ///< what each effect was worth when it joined
  double done_ = 0.05;            ///< share of the work, about
};

}  // namespace

double Explanation::score() const {
  return deviance + kParameterCost * static_cast<double>(fit.free.size()) +
         kEffectCost * static_cast<double>(fit.model.effects.size());
}

SearchResult search(Likelihood& likelihood, const SearchOptions& options) {
  return Search{likelihood, options}.run();
}

}  // namespace teleop
