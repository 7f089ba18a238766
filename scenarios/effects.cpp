#include "scenarios/effects.hpp"

#include <cmath>
#include <cstdio>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/effects/vocabulary.hpp"
#include "scenarios/output.hpp"

namespace teleop {
namespace {

std::string range_of(const EffectParameter& parameter) {
  const auto [low, high] = parameter.range;
  if (std::isinf(low) && std::isinf(high)) return "any";
  if (std::isinf(high)) return low > 0.0 ? "more than 0" : fmt::format("{} or more", low);
  return fmt::format("{} to {}", low, high);
}

std::string default_of(const EffectParameter& parameter) {
  return parameter.standard ? fmt::format("{}", *parameter.standard) : "";
}

void print(const EffectKind& kind) {
  fmt::print("{}{}\n  {}\n", kind.name, kind.per_axis ? "" : "  (whole arm)", kind.law);
  for (const EffectParameter& parameter : kind.parameters) {
    const std::string standard = default_of(parameter);
    fmt::print("    {:<27} {:<10} {}: {}{}\n", parameter.name, parameter.unit, parameter.text,
               range_of(parameter), standard.empty() ? "" : ", default " + standard);
  }
  fmt::print("\n");
}

nlohmann::json json_of(const EffectKind& kind) {
  nlohmann::json parameters = nlohmann::json::array();
  for (const EffectParameter& parameter : kind.parameters) {
    nlohmann::json one{{"name", parameter.name},
                       {"unit", parameter.unit},
                       {"text", parameter.text},
                       {"allowed", range_of(parameter)}};
    if (parameter.standard) one["default"] = *parameter.standard;
    parameters.push_back(one);
  }
  return {{"kind", kind.name},
          {"law", kind.law},
          {"per_axis", kind.per_axis},
          {"parameters", parameters}};
}

/// Bars would end a cell.
std::string cell(std::string_view text) {
  std::string result;
  for (const char c : text) {
    if (c == '|') result += '\\';
    result += c;
  }
  return result;
}

}  // namespace

std::string effects_as_markdown() {
  std::string out =
      "# Effects\n\n"
      "What may make an arm differ from the ideal one: the `[[effect]]` tables of plant files. q "
      "is "
      "the angle of the link, m\nthat of the drive (the same where nothing gives way between "
      "them), u "
      "the commanded and a the delivered torque of an\naxis, y its reading; ' is the derivative in "
      "time. A command passes delay, saturation, dead zone, gain with thermal\nloss and lag, in "
      "this "
      "order; bias, ripple and coupling are added. Friction acts on the drive.\n\n"
      "This page is printed by `teleop effects --markdown`.\n";
  for (const EffectKind* kind : vocabulary()) {
    out += fmt::format(
        "\n## {}\n\n{}`{}`\n\n| parameter | unit | meaning | allowed | default |\n"
        "|---|---|---|---|---|\n",
        kind->name, kind->per_axis ? "" : "Whole arm. ", kind->law);
    for (const EffectParameter& parameter : kind->parameters) {
      out += fmt::format("| `{}` | {} | {} | {} | {} |\n", parameter.name, parameter.unit,
                         cell(parameter.text), range_of(parameter), default_of(parameter));
    }
  }
  return out;
}

int run_effects(const EffectsOptions& options) {
  nlohmann::json list = nlohmann::json::array();
  if (!options.kind.empty()) {
    const EffectKind& kind = find_effect(options.kind);
    print(kind);
    list.push_back(json_of(kind));
  } else {
    if (options.markdown) std::fputs(effects_as_markdown().c_str(), stdout);
    for (const EffectKind* kind : vocabulary()) {
      if (!options.markdown) print(*kind);
      list.push_back(json_of(*kind));
    }
  }
  if (!options.json.empty()) write_json(options.json, {{"effects", list}});
  return 0;
}

}  // namespace teleop
