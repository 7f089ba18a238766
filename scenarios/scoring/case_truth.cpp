#include "scenarios/scoring/case_truth.hpp"

#include <algorithm>

#include <nlohmann/json.hpp>

#include "core/base/error.hpp"
#include "scenarios/scoring/vocabulary_rules.hpp"

namespace teleop {
namespace {

double lower_end(const std::string& band) {
  if (band == "obvious") return 0.10;
  if (band == "visible") return 0.02;
  return band == "faint" ? 0.005 : 0.0;
}

TrueEffect read_effect(const nlohmann::json& json) {
  TrueEffect effect;
  effect.name.kind = json.at("kind");
  if (!json.at("axis").is_null()) effect.name.axis = json.at("axis").get<int>();
  effect.parameters = json.at("parameters").get<std::map<std::string, double>>();
  effect.in_vocabulary = find_rule(effect.name.kind) != nullptr;
  effect.visible_alone = json.value("band_alone", "visible") != "invisible";
  return effect;
}

}  // namespace

Content CaseTruth::content() const {
  if (effects.empty()) return Content::nothing;
  const bool known = std::all_of(effects.begin(), effects.end(),
                                 [](const TrueEffect& each) { return each.in_vocabulary; });
  if (!known) return Content::stranger;
  return effects.size() == 1 ? Content::one : Content::several;
}

CaseTruth read_truth(const nlohmann::json& json) {
  try {
    CaseTruth truth;
    truth.name = json.at("case");
    truth.group = json.at("class");
    truth.sort = json.at("sub");
    truth.dnr = json.value("dnr_held_out", lower_end(json.value("band", "visible")));
    truth.channels = json.at("channels").get<std::vector<std::string>>();
    truth.effects.reserve(json.at("effects").size());
    for (const nlohmann::json& each : json.at("effects")) {
      truth.effects.push_back(read_effect(each));
    }
    drop_absorbed(truth.effects);
    return truth;
  } catch (const nlohmann::json::exception& error) {
    throw ConfigError{std::string{"the truth of a case: "} + error.what()};
  }
}

}  // namespace teleop
