#include "scenarios/scoring/score.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include "scenarios/scoring/equivalence.hpp"
#include "scenarios/scoring/vocabulary_rules.hpp"

namespace teleop {
namespace {

constexpr double kNamed = 0.5;
constexpr double kListed = 0.1;
constexpr std::size_t kMostAlternatives = 4;
constexpr double kIn90 = 1.645;  // standard errors

using Effects = std::vector<GivenEffect>;

bool contains(const std::vector<EffectName>& names, const EffectName& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

/// The source belongs to the name of a coupling.
bool same_source(const TrueEffect& truth, const GivenEffect& given) {
  if (truth.name.kind != "axis_coupling") return true;
  const auto found = given.parameters.find("from_axis");
  return found != given.parameters.end() &&
         std::lround(found->second.value) == std::lround(truth.parameters.at("from_axis"));
}

bool matches(const TrueEffect& truth, const GivenEffect& given) {
  if (given.name == truth.name) return same_source(truth, given);
  return given.alternatives.size() <= kMostAlternatives &&
         contains(equivalents(truth), given.name) &&
         std::any_of(given.alternatives.begin(), given.alternatives.end(), [&](const auto& each) {
           return each.name == truth.name && each.confidence >= kListed;
         });
}

bool has_in_set(const TrueEffect& truth, const GivenEffect& given) {
  if (given.name == truth.name) return true;
  return given.alternatives.size() <= kMostAlternatives &&
         std::any_of(given.alternatives.begin(), given.alternatives.end(), [&](const auto& each) {
           return each.name == truth.name && each.confidence > kListed;
         });
}

/// What an answer and a truth come down to.
struct Sides {
  std::vector<TrueEffect> truth{};  ///< of the vocabulary
  Effects known{};                  ///< of the vocabulary, the most confident first
  Effects sure{};

  [[nodiscard]] bool is_there(const GivenEffect& given) const {
    return std::any_of(truth.begin(), truth.end(),
                       [&](const TrueEffect& each) { return matches(each, given); });
  }
  [[nodiscard]] bool may_be_there(const GivenEffect& given) const {
    return std::any_of(truth.begin(), truth.end(),
                       [&](const TrueEffect& each) { return has_in_set(each, given); });
  }
  /// The first effect and its alternatives are a claim together.
  [[nodiscard]] bool firm() const {
    if (known.empty()) return false;
    double sum = known.front().confidence;
    const auto& others = known.front().alternatives;
    for (std::size_t i = 0; i < std::min(kMostAlternatives, others.size()); ++i) {
      sum += others[i].confidence;
    }
    return sum >= kNamed;
  }
};

Sides sides_of(const CaseTruth& truth, const GivenAnswer& answer) {
  Sides sides;
  std::copy_if(truth.effects.begin(), truth.effects.end(), std::back_inserter(sides.truth),
               [](const TrueEffect& each) { return each.in_vocabulary; });
  if (answer.verdict == "adequate") return sides;
  std::copy_if(answer.effects.begin(), answer.effects.end(), std::back_inserter(sides.known),
               [](const GivenEffect& each) { return find_rule(each.name.kind) != nullptr; });
  std::stable_sort(
      sides.known.begin(), sides.known.end(),
      [](const GivenEffect& a, const GivenEffect& b) { return a.confidence > b.confidence; });
  std::copy_if(sides.known.begin(), sides.known.end(), std::back_inserter(sides.sure),
               [](const GivenEffect& each) { return each.confidence >= kNamed; });
  return sides;
}

bool names_wrongly(const Sides& sides, bool detected, bool stranger) {
  if (!std::all_of(sides.sure.begin(), sides.sure.end(),
                   [&](const GivenEffect& each) { return sides.is_there(each); })) {
    return true;
  }
  const bool unsure = !sides.known.empty() && sides.known.front().confidence < kNamed;
  return unsure && detected && !stranger && !sides.may_be_there(sides.known.front());
}

void score_pair(const Sides& sides, CaseScore& result) {
  std::size_t needed = 0;
  std::size_t hit = 0;
  for (const TrueEffect& each : sides.truth) {
    if (!each.visible_alone) continue;
    ++needed;
    const bool named = std::any_of(sides.sure.begin(), sides.sure.end(),
                                   [&](const GivenEffect& given) { return matches(each, given); });
    hit += named ? 1U : 0U;
  }
  result.pair_any = hit > 0;
  result.pair_exact = needed > 0 && hit == needed && !result.wrong_name;
}

void score_place(const CaseTruth& truth,
                 const GivenAnswer& answer,
                 const Sides& sides,
                 CaseScore& result) {
  std::set<int> axes;
  bool whole_arm = false;
  for (const TrueEffect& each : truth.effects) {
    whole_arm = whole_arm || !each.name.axis;
    if (each.name.axis) axes.insert(*each.name.axis);
  }
  std::set<int> given{answer.axes.begin(), answer.axes.end()};
  for (const GivenEffect& each : sides.sure) {
    if (each.name.axis) given.insert(*each.name.axis);
  }
  if (!whole_arm) result.axis = given == axes;

  const std::set<std::string> said{answer.channels.begin(), answer.channels.end()};
  const bool stranger = truth.content() == Content::stranger;
  std::set<std::string> channels{truth.channels.begin(), truth.channels.end()};
  if (!sides.truth.empty() && !stranger) {
    channels.clear();
    for (const TrueEffect& each : sides.truth) {
      channels.emplace(channel_of(each.name.kind));
    }
  }
  const auto an_equivalent_says_so = [&](const TrueEffect& each) {
    const auto names = equivalents(each);
    return std::any_of(names.begin(), names.end(), [&](const EffectName& name) {
      return said.contains(std::string{channel_of(name.kind)});
    });
  };
  result.channel = said == channels ||
                   (stranger && (said.contains("unknown") || said.contains("joint"))) ||
                   std::any_of(sides.truth.begin(), sides.truth.end(), an_equivalent_says_so);
}

void collect_claims(const Sides& sides, CaseScore& result) {
  const auto holds = [&](const EffectName& name) {
    return std::any_of(sides.truth.begin(), sides.truth.end(),
                       [&](const TrueEffect& each) { return each.name == name; });
  };
  const auto add = [&](const EffectName& name, double confidence) {
    if (find_rule(name.kind) == nullptr) return;
    result.claims.push_back({std::clamp(confidence, 0.0, 1.0), holds(name)});
  };
  for (const GivenEffect& each : sides.known) {
    add(each.name, each.confidence);
    for (const GivenEffect::Alternative& other : each.alternatives) {
      add(other.name, other.confidence);
    }
  }
}

/// What an error of the parameter is measured by.
double scale_of(const GradedParameter& graded,
                const TrueEffect& truth,
                const KindRule& rule,
                const GivenEffect& given) {
  if (graded.fixed > 0.0) return graded.fixed;
  const double own = std::abs(truth.parameters.at(std::string{graded.name}) - graded.nominal);
  double square = 0.0;
  bool all_given = rule.vector;
  for (const GradedParameter& each : rule.graded) {
    all_given = all_given && given.parameters.contains(std::string{each.name});
    square += std::pow(truth.parameters.at(std::string{each.name}), 2.0);
  }
  const double scale = all_given ? std::sqrt(square) : own;
  return scale > 0.0 ? scale : 1e-12;
}

void collect_parameters(const Sides& sides, CaseScore& result) {
  for (const TrueEffect& truth : sides.truth) {
    const auto given =
        std::find_if(sides.known.begin(), sides.known.end(),
                     [&](const GivenEffect& each) { return each.name == truth.name; });
    if (given == sides.known.end()) continue;
    const KindRule& rule = *find_rule(truth.name.kind);
    for (const GradedParameter& graded : rule.graded) {
      const std::string name{graded.name};
      const auto value = given->parameters.find(name);
      if (value == given->parameters.end()) continue;
      const double error = std::abs(value->second.value - truth.parameters.at(name));
      std::optional<bool> covered;
      if (value->second.deviation > 0.0) covered = error <= kIn90 * value->second.deviation;
      result.parameters.push_back({.name = truth.name.kind + "." + name,
                                   .relative = error / scale_of(graded, truth, rule, *given),
                                   .covered = covered});
    }
  }
}

}  // namespace

bool CaseScore::good() const noexcept {
  switch (content) {
    case Content::nothing:
      return !detected && !missing;
    case Content::one:
      return right && !wrong_name;
    case Content::several:
      return pair_exact;
    case Content::stranger:
      return flagged;
  }
  return false;
}

CaseScore score(const CaseTruth& truth, const std::optional<GivenAnswer>& answer) {
  const GivenAnswer given =
      answer.value_or(GivenAnswer{.verdict = "missing", .channels = {"none"}});
  const Sides sides = sides_of(truth, given);
  CaseScore result{.content = truth.content(),
                   .group = truth.group,
                   .sort = truth.sort,
                   .kind = truth.effects.empty() ? "" : truth.effects.front().name.kind,
                   .dnr = truth.dnr,
                   .missing = !answer,
                   .detected = given.detects(),
                   .silent = !sides.firm(),
                   .over_floor = given.over_floor};
  const bool stranger = result.content == Content::stranger;
  result.wrong_name = names_wrongly(sides, result.detected, stranger);
  result.right = sides.firm() && sides.is_there(sides.known.front());
  result.in_set = sides.firm() && sides.may_be_there(sides.known.front());
  const bool explicable = result.content == Content::one || result.content == Content::several;
  result.false_flag = explicable && given.leaves_something();
  if (result.content == Content::several) score_pair(sides, result);
  result.flagged = stranger && given.leaves_something();
  result.misnamed = stranger && given.verdict == "explained" && !sides.sure.empty();
  score_place(truth, given, sides, result);
  collect_claims(sides, result);
  collect_parameters(sides, result);
  return result;
}

}  // namespace teleop
