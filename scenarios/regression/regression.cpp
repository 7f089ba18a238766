#include "scenarios/regression/regression.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "core/effects/vocabulary.hpp"
#include "scenarios/regression/final_fit.hpp"

namespace teleop {
namespace {

using Json = nlohmann::ordered_json;
using Name = std::pair<std::string, std::size_t>;

constexpr double kLeftover = 25.0;  // χ² of one degree that some thirty probes do not reach
constexpr double kWorthMention = 0.005;
constexpr std::size_t kMostAlternatives = 4;
constexpr double kNamedShare = 0.55;  // of two that cannot be told apart

/// Probabilities of what could stand in the place of one chosen form, itself first.
struct Rivals {
  double own = 1.0;
  std::vector<std::pair<Form, double>> others{};  ///< the likeliest first
};

Rivals rivals_of(const Design& design, const ModelChoice& choice, std::size_t place) {
  const double least = choice.fit(choice.chosen(), Rows::training).bic;
  std::map<Name, std::pair<double, const Form*>> best;
  for (std::size_t index = 0; index < design.forms().size(); ++index) {
    const Form& form = design.forms()[index];
    if (form.same_name(design.forms()[choice.chosen()[place]])) continue;
    ModelChoice::Choice other = choice.chosen();
    other[place] = index;
    const ModelChoice::Fitted fitted = choice.fit(other, Rows::training);
    if (!choice.possible(other, fitted)) continue;
    const Name name{form.regressor->kind, form.axis};
    const auto found = best.find(name);
    if (found == best.end() || fitted.bic < found->second.first) best[name] = {fitted.bic, &form};
  }
  ModelChoice::Choice without = choice.chosen();
  without.erase(without.begin() + static_cast<std::ptrdiff_t>(place));
  const auto weight = [least](double bic) {
    return std::exp(-std::max(0.0, bic - least) / 2.0);
  };
  double sum = 1.0 + weight(choice.fit(without, Rows::training).bic);
  Rivals rivals;
  for (const auto& [name, rival] : best) {
    rivals.others.emplace_back(*rival.second, weight(rival.first));
    sum += weight(rival.first);
  }
  rivals.own /= sum;
  for (auto& [form, share] : rivals.others) {
    share /= sum;
  }
  std::stable_sort(rivals.others.begin(), rivals.others.end(),
                   [](const auto& a, const auto& b) { return a.second > b.second; });
  return rivals;
}

Json axis_of(const Regressor& regressor, std::size_t axis) {
  return regressor.per_axis ? Json(axis + 1) : Json(nullptr);
}

Json effect_json(const FinalFit::Effect& effect,
                 const std::vector<Regressor::Parameter>& parameters,
                 const Rivals& rivals) {
  const Regressor& regressor = *effect.regressor;
  Json list = Json::array();
  for (const Regressor::Parameter& each : parameters) {
    list.push_back({{"name", each.name}, {"value", each.value}, {"std", each.deviation}});
  }
  // A late reading and a late command are the same to a regression; one has to be named.
  const bool delay = regressor.kind == "actuation_delay";
  const double own = delay ? kNamedShare * rivals.own : rivals.own;
  Json others = Json::array();
  const auto add = [&others](std::string_view kind, Json axis, double confidence) {
    if (confidence < kWorthMention || others.size() >= kMostAlternatives) return;
    others.push_back({{"kind", kind}, {"axis", std::move(axis)}, {"confidence", confidence}});
  };
  if (delay) add("sensor_delay", effect.axis + 1, rivals.own - own);
  for (const auto& [form, share] : rivals.others) {
    add(form.regressor->kind, axis_of(*form.regressor, form.axis), share);
  }
  return {{"kind", regressor.kind},
          {"axis", axis_of(regressor, effect.axis)},
          {"confidence", own},
          {"parameters", list},
          {"alternatives", others}};
}

struct Leftover {
  double gain = 0.0;
  std::size_t axis = 0;
  std::string_view quantity{};
};

/// Whatever the vocabulary is, correlated residuals are counted as such here: plain counting would
/// call everything unexplained.
Leftover leftover_of(const Design& design, const ModelChoice& choice) {
  const FinalFit fit = final_fit(design, choice, Counting::correlated);
  Leftover most;
  for (const Regressor& probe : leftover_probes()) {
    for (std::size_t axis = 0; axis < kJoints; ++axis) {
      const double gain = gain_of(fit, design.columns(probe, axis, 0.0).col(0));
      if (gain > most.gain) most = {gain, axis, probe.kind};
    }
  }
  return most;
}

Json fit_json(const DiagnosisCase& data, const ModelChoice& choice) {
  const JointVector before = choice.left_out({}).cwiseSqrt();
  const JointVector after = choice.left_out(choice.chosen()).cwiseSqrt();
  Eigen::Index axis = 0;
  (before - after).maxCoeff(&axis);
  return {{"nominal_nrmse", before[axis]},
          {"corrected_nrmse", after[axis]},
          {"noise_floor_nrmse", 1.0},
          {"held_out_runs", {data.runs.back().name}}};
}

Json mismatch_json(const Json& effects, bool left, const Leftover& leftover) {
  Json axes = Json::array();
  std::set<std::string_view> channels;
  if (left) channels.insert("unknown");
  for (const Json& effect : effects) {
    channels.insert(text_of(find_effect(effect.at("kind").get<std::string>()).channel));
    const Json& axis = effect.at("axis");
    if (!axis.is_null() && std::find(axes.begin(), axes.end(), axis) == axes.end()) {
      axes.push_back(axis);
    }
  }
  const std::string where = left ? "follows " + std::string{leftover.quantity} : "";
  return {{"axes", axes},
          {"channel", channels},
          {"where", where},
          {"p_value", std::erfc(std::sqrt(leftover.gain / 2.0))}};
}

}  // namespace

Json regress(const Design& design, const DiagnosisCase& data, Counting counting) {
  const ModelChoice choice{design, counting};
  const FinalFit fit = final_fit(design, choice, counting);
  Json effects = Json::array();
  for (std::size_t i = 0; i < fit.effects.size(); ++i) {
    const FinalFit::Effect& effect = fit.effects[i];
    const auto parameters = effect.regressor->parameters(
        effect.estimate, {design.arm(), effect.axis, effect.estimate.shape});
    // On all rows, and between the points of the grid, it may have become impossible.
    if (parameters) {
      effects.push_back(effect_json(effect, *parameters, rivals_of(design, choice, i)));
    }
  }
  const Leftover leftover = leftover_of(design, choice);
  const bool left = leftover.gain > kLeftover;
  const char* verdict = left ? "unexplained" : "adequate";
  if (!effects.empty()) verdict = left ? "partly_explained" : "explained";
  return {{"verdict", verdict},
          {"mismatch", mismatch_json(effects, left, leftover)},
          {"effects", effects},
          {"fit", fit_json(data, choice)},
          {"next_experiment", ""}};
}

}  // namespace teleop
