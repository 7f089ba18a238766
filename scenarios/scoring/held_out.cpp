#include "scenarios/scoring/held_out.hpp"

#include <algorithm>
#include <vector>

#include <nlohmann/json.hpp>

#include "core/base/error.hpp"
#include "scenarios/concealed/judge.hpp"
#include "scenarios/scoring/given_answer.hpp"
#include "scenarios/scoring/vocabulary_rules.hpp"

namespace teleop {
namespace {

constexpr int kSteps = 8;  // of a sample, as the DNR is judged
constexpr double kWorst = 1e6;

using concealed::Device;
using concealed::Effect;

/// What the answer would put into a model. Conventions of scoring do not apply: a bias beside a
/// friction acts.
std::vector<Effect> effects_of(const nlohmann::json& answer) {
  std::vector<Effect> effects;
  if (answer.at("verdict") == "adequate") return effects;
  for (const nlohmann::json& each : answer.at("effects")) {
    if (find_rule(each.at("kind").get<std::string>()) == nullptr) continue;
    Effect effect{.kind = each.at("kind")};
    if (!each.at("axis").is_null()) effect.axis = each.at("axis").get<std::size_t>() - 1;
    for (const nlohmann::json& parameter : each.at("parameters")) {
      effect.parameters.emplace_back(parameter.at("name"), parameter.at("value"));
    }
    // Optional in an answer; the first of a name counts.
    const bool lopsided = effect.kind == "viscous_friction" || effect.kind == "coulomb_friction";
    if (lopsided) effect.parameters.emplace_back("asymmetry", 0.0);
    effects.push_back(std::move(effect));
  }
  return effects;
}

}  // namespace

double held_out_over_true(const concealed::ConcealedCase& drawn, const nlohmann::json& answer) {
  const std::size_t last = concealed::kRuns - 1;
  const concealed::JudgedRun judged{last, &drawn.runs.at(last)};
  const JointVector truth = innovations(drawn.device, judged, true, kSteps);
  Device found = drawn.device;
  try {
    found.effects = effects_of(answer);
    const JointVector ours = innovations(found, judged, true, kSteps);
    const double ratio = ours.cwiseQuotient(truth).maxCoeff();
    return ours.allFinite() ? std::min(ratio, kWorst) : kWorst;
  } catch (const ConfigError&) {
    return kWorst;  // a parameter is missing: such a model cannot predict anything
  } catch (const nlohmann::json::exception&) {
    return kWorst;  // nor can an answer of another shape
  }
}

}  // namespace teleop
