#include "core/diagnosis/answer.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "core/diagnosis/miss_words.hpp"
#include "core/diagnosis/self_check.hpp"
#include "core/effects/vocabulary.hpp"

namespace teleop {
namespace {

using Json = nlohmann::ordered_json;

/// Evidence counts less than it seems: quantised readings are not quite normal noise.
constexpr double kTemperature = 3.0;
/// A regularity that is left with more than this is no accident.
constexpr double kLeftover = 30.0;
constexpr double kBeyondReplicas = 2.0;

/// Probability that the largest of so many independent values that are χ² of one degree exceeds
/// this one.
double p_value_of(double largest, double tests) {
  const double one = std::erfc(std::sqrt(std::max(largest, 0.0) / 2.0));
  return -std::expm1(tests * std::log1p(-std::min(one, 1.0 - 1e-16)));
}

/// RMS of whitened innovations a run and axis, of parameters that fit the other runs.
JointVector left_out_rms(const Fit& fit) {
  JointVector sum = JointVector::Zero();
  double rows = 0.0;
  for (std::size_t run = 0; run < fit.errors.size(); ++run) {
    const Eigen::VectorXf w = fit.left_out_errors(run);
    const Eigen::Map<const Eigen::Matrix<float, 3, Eigen::Dynamic>> axes{w.data(), 3, w.size() / 3};
    sum += axes.cast<double>().rowwise().squaredNorm();
    rows += static_cast<double>(axes.cols());
  }
  return (sum / rows).cwiseSqrt();
}

HeldOutFit held_out(Likelihood& likelihood, const Explanation& best) {
  HeldOutFit result;
  for (const Recording& run : likelihood.data().runs) {
    result.runs.push_back(run.name);
  }
  likelihood.set_noise(best.noise);
  const Fit nominal = fit(likelihood, base_columns(likelihood, {}), {});
  const JointVector before = left_out_rms(nominal);
  const JointVector after = left_out_rms(best.fit);
  Eigen::Index axis = 0;
  (before - after).maxCoeff(&axis);
  result.nominal = before[axis];
  result.corrected = after[axis];
  return result;
}

/// @param replicas what seemed to be left over of recordings that the explanation itself made
Verdict judge(const Diagnosis& diagnosis, double replicas) {
  const double left = diagnosis.leftovers.empty() ? 0.0 : diagnosis.leftovers.front().gain;
  const bool rest = left > std::max(kLeftover, kBeyondReplicas * replicas);
  if (diagnosis.found.effects.empty()) return rest ? Verdict::unexplained : Verdict::adequate;
  return rest ? Verdict::partly_explained : Verdict::explained;
}

bool something_is_left(const Diagnosis& diagnosis) {
  return diagnosis.verdict == Verdict::partly_explained ||
         diagnosis.verdict == Verdict::unexplained;
}

void weigh_rivals(Diagnosis& diagnosis) {
  // Where something is left over, what was named may only stand for it.
  const double sure = something_is_left(diagnosis) ? 0.4 : 0.99;
  for (const NamedEffect& effect : diagnosis.found.effects) {
    std::vector<double> weights;
    double sum = 1.0 + std::exp(-effect.gain / (2.0 * kTemperature));
    for (const NamedEffect::Rival& rival : effect.rivals) {
      weights.push_back(std::exp(-std::max(rival.behind, 0.0) / (2.0 * kTemperature)));
      sum += weights.back();
    }
    for (double& weight : weights) {
      weight *= sure / sum;
    }
    diagnosis.confidences.push_back(sure / sum);
    diagnosis.rival_confidences.push_back(std::move(weights));
  }
}

Json axis_of(const EffectSpec& effect, const DiagnosisCase& data) {
  if (!effect.axis) return nullptr;
  if (data.bench.empty()) return *effect.axis + 1;
  return data.bench[*effect.axis].name;
}

Json parameters_of(const NamedEffect& named) {
  Json list = Json::array();
  for (const EffectParameter& parameter : find_effect(named.effect.kind).parameters) {
    const auto value = named.effect.parameters.find(std::string{parameter.name});
    if (value == named.effect.parameters.end()) continue;
    double deviation = 0.0;
    for (std::size_t i = 0; i < named.free.size(); ++i) {
      if (named.free[i].name != parameter.name) continue;
      deviation = named.deviations[static_cast<Eigen::Index>(i)];
      if (named.free[i].logarithmic) deviation *= std::abs(value->second);
    }
    list.push_back({{"name", parameter.name},
                    {"value", value->second},
                    {"std", deviation},
                    {"unit", parameter.unit}});
  }
  return list;
}

Json leftover_axis(const Leftover& leftover, const DiagnosisCase& data) {
  return data.bench.empty() ? Json(leftover.axis + 1) : Json(data.bench[leftover.axis].name);
}

Json rivals_of(const Diagnosis& diagnosis, std::size_t effect, const DiagnosisCase& data) {
  constexpr double kWorthMention = 0.005;
  const NamedEffect& named = diagnosis.found.effects[effect];
  Json list = Json::array();
  for (std::size_t j = 0; j < named.rivals.size(); ++j) {
    const double confidence = diagnosis.rival_confidences[effect][j];
    if (confidence < kWorthMention) continue;
    list.push_back({{"kind", named.rivals[j].effect.kind},
                    {"axis", axis_of(named.rivals[j].effect, data)},
                    {"confidence", confidence}});
  }
  return list;
}

Json effects_of(const Diagnosis& diagnosis, const DiagnosisCase& data) {
  Json list = Json::array();
  for (std::size_t i = 0; i < diagnosis.found.effects.size(); ++i) {
    const NamedEffect& named = diagnosis.found.effects[i];
    list.push_back({{"kind", named.effect.kind},
                    {"axis", axis_of(named.effect, data)},
                    {"confidence", diagnosis.confidences[i]},
                    {"parameters", parameters_of(named)},
                    {"alternatives", rivals_of(diagnosis, i, data)}});
  }
  if (something_is_left(diagnosis)) {
    list.push_back({{"kind", "unknown"},
                    {"axis", leftover_axis(diagnosis.leftovers.front(), data)},
                    {"confidence", 0.9},
                    {"parameters", Json::array()},
                    {"alternatives", Json::array()},
                    {"text", where_of(diagnosis)}});
  }
  return list;
}

/// Where causes sit: axes, each once, and channels, one word or a list.
Json mismatch_of(const Diagnosis& diagnosis, const DiagnosisCase& data) {
  std::set<std::string_view> channels;
  Json axes = Json::array();
  const auto add = [&axes](const Json& axis) {
    const bool known = std::find(axes.begin(), axes.end(), axis) != axes.end();
    if (!axis.is_null() && !known) axes.push_back(axis);
  };
  for (const NamedEffect& named : diagnosis.found.effects) {
    channels.insert(text_of(find_effect(named.effect.kind).channel));
    add(axis_of(named.effect, data));
  }
  if (something_is_left(diagnosis)) {
    channels.insert("unknown");
    add(leftover_axis(diagnosis.leftovers.front(), data));
  }
  Json channel = channels.size() > 1 ? Json(channels) : Json("none");
  if (channels.size() == 1) channel = *channels.begin();
  return {{"axes", axes},
          {"channel", channel},
          {"where", where_of(diagnosis)},
          {"p_value", diagnosis.p_value}};
}

}  // namespace

std::string_view text_of(Verdict verdict) noexcept {
  switch (verdict) {
    case Verdict::adequate:
      return "adequate";
    case Verdict::explained:
      return "explained";
    case Verdict::partly_explained:
      return "partly_explained";
    case Verdict::unexplained:
      return "unexplained";
  }
  return "unexplained";
}

std::string where_of(const Diagnosis& diagnosis) {
  std::vector<std::string> parts;
  if (diagnosis.found.unfinished) parts.emplace_back("unfinished, the search was stopped");
  if (!diagnosis.where.where.empty()) parts.push_back(diagnosis.where.where);
  if (something_is_left(diagnosis)) {
    const Leftover& first = diagnosis.leftovers.front();
    const std::string& when = diagnosis.where.left_over.at(first.axis);
    parts.push_back(fmt::format("left on axis {} is {}{}{}", first.axis + 1, text_of(first),
                                when.empty() ? "" : ", ", when));
  }
  if (parts.empty()) return "nothing stands out of the noise";
  return fmt::format("{}", fmt::join(parts, "; "));
}

Diagnosis diagnose(Likelihood& likelihood, const SearchOptions& options) {
  constexpr double kPlaces = 100.0;  // independent ones among trials, about
  Diagnosis diagnosis;
  diagnosis.found = search(likelihood, options);
  likelihood.set_noise(diagnosis.found.best.noise);
  Leftovers left = leftovers(likelihood, diagnosis.found.best.fit);
  diagnosis.leftovers = std::move(left.all);
  double replicas = 0.0;
  const bool worth_a_check =
      !diagnosis.found.effects.empty() || judge(diagnosis, 0.0) != Verdict::adequate;
  if (worth_a_check && !diagnosis.found.unfinished) {
    if (options.progress) options.progress("replicas");
    const SelfCheck check = self_check(likelihood, diagnosis.found.best);
    widen(diagnosis.found, check);
    replicas = check.leftover;
  }
  diagnosis.verdict = judge(diagnosis, replicas);
  diagnosis.p_value = left.p_value;
  for (const NamedEffect& effect : diagnosis.found.effects) {
    diagnosis.p_value = std::min(diagnosis.p_value, p_value_of(effect.gain, kPlaces));
  }
  diagnosis.fit = held_out(likelihood, diagnosis.found.best);
  weigh_rivals(diagnosis);
  likelihood.set_noise(diagnosis.found.best.noise);
  const auto say = [&options](const char* text) {
    if (options.progress) options.progress(text);
  };
  say("locating");
  diagnosis.where = localise(likelihood, diagnosis.found);
  if (diagnosis.found.effects.empty() && !diagnosis.leftovers.empty()) {
    diagnosis.where.axis = diagnosis.leftovers.front().axis;
  }
  diagnosis.free = free_run(likelihood, diagnosis.found);
  if (diagnosis.found.unfinished) {
    diagnosis.next.text = "none yet: run the diagnosis to its end";
    return diagnosis;
  }
  say("choosing the next experiment");
  diagnosis.next =
      next_experiment(likelihood, diagnosis.found,
                      something_is_left(diagnosis) ? diagnosis.leftovers.front().quantity : "");
  return diagnosis;
}

nlohmann::ordered_json answer_of(const Diagnosis& diagnosis, const DiagnosisCase& data) {
  return {{"verdict", text_of(diagnosis.verdict)},
          {"mismatch", mismatch_of(diagnosis, data)},
          {"effects", effects_of(diagnosis, data)},
          {"fit",
           {{"nominal_nrmse", diagnosis.fit.nominal},
            {"corrected_nrmse", diagnosis.fit.corrected},
            {"noise_floor_nrmse", diagnosis.fit.floor},
            {"held_out_runs", diagnosis.fit.runs}}},
          {"next_experiment", diagnosis.next.text}};
}

}  // namespace teleop
