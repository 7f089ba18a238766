#include "scenarios/scoring/given_answer.hpp"

#include <sstream>

#include <nlohmann/json.hpp>

#include "scenarios/scoring/vocabulary_rules.hpp"

namespace teleop {
namespace {

using nlohmann::json;

const json& member(const json& object, const char* key) {
  static const json nothing;
  if (!object.is_object()) return nothing;
  const auto found = object.find(key);
  return found == object.end() ? nothing : *found;
}

double number(const json& object, const char* key) {
  const json& value = member(object, key);
  return value.is_number() ? value.get<double>() : 0.0;
}

std::string text(const json& object, const char* key) {
  const json& value = member(object, key);
  return value.is_string() ? value.get<std::string>() : std::string{};
}

EffectName name_of(const json& effect) {
  EffectName name{.kind = text(effect, "kind")};
  const json& axis = member(effect, "axis");
  if (axis.is_number_integer()) name.axis = axis.get<int>();
  return name;
}

GivenEffect effect_of(const json& given) {
  GivenEffect effect{.name = name_of(given), .confidence = number(given, "confidence")};
  for (const json& each : member(given, "parameters")) {
    if (!member(each, "value").is_number()) continue;
    effect.parameters[text(each, "name")] = {number(each, "value"), number(each, "std")};
  }
  effect.alternatives.reserve(member(given, "alternatives").size());
  for (const json& each : member(given, "alternatives")) {
    effect.alternatives.push_back({name_as_compared(name_of(each)), number(each, "confidence")});
  }
  return effect;
}

/// A word, several with commas or bars between them, or a list.
std::vector<std::string> channels_of(const json& channel) {
  if (channel.is_array() && !channel.empty()) return channel.get<std::vector<std::string>>();
  std::string words = channel.is_string() ? channel.get<std::string>() : "none";
  for (char& c : words) {
    if (c == ',' || c == '|') c = ' ';
  }
  std::istringstream stream{words};
  std::vector<std::string> list;
  for (std::string word; stream >> word;) {
    list.push_back(word);
  }
  return list;
}

}  // namespace

std::optional<GivenAnswer> read_answer(const json& given) {
  if (!given.is_object() || !member(given, "verdict").is_string()) return std::nullopt;
  GivenAnswer answer{.verdict = given["verdict"]};
  const json& mismatch = member(given, "mismatch");
  for (const json& axis : member(mismatch, "axes")) {
    if (axis.is_number_integer()) answer.axes.push_back(axis);
  }
  answer.channels = channels_of(member(mismatch, "channel"));
  answer.effects.reserve(member(given, "effects").size());
  for (const json& each : member(given, "effects")) {
    if (each.is_object()) answer.effects.push_back(effect_of(each));
  }
  drop_absorbed(answer.effects);
  for (GivenEffect& each : answer.effects) {
    each.name = name_as_compared(each.name);
  }
  const json& fit = member(given, "fit");
  const double floor = number(fit, "noise_floor_nrmse");
  if (floor > 0.0) answer.over_floor = number(fit, "corrected_nrmse") / floor;
  return answer;
}

}  // namespace teleop
