#include "core/effects/plant_spec.hpp"

#include <algorithm>
#include <sstream>

#include <fmt/format.h>
#include <toml++/toml.h>

#include "core/base/error.hpp"
#include "core/base/settings.hpp"
#include "core/effects/text_file.hpp"
#include "core/effects/vocabulary.hpp"

namespace teleop {
namespace {

constexpr const char* kEffectTables = "effect";

void add_plain_settings(Settings& settings, const std::string& prefix, PlantSpec& plant) {
  settings.add(prefix + "arm", &plant.arm, "name or file of the arm");
  settings.add(prefix + "name", &plant.name, "of the plant, free text");
  settings.add(prefix + "sensing.quantised", &plant.sensing.quantised, "angles in encoder counts");
  settings.add(prefix + "drive.torque_command_step_Nm", &plant.drive.torque_command_step_Nm,
               "step of the torque command, 0: none", kNotNegative);
  settings.add(prefix + "drive.max_force_N", &plant.drive.max_force_N,
               "limit of the command at the tool, 0: none", kNotNegative);
  settings.add(prefix + "drive.delay_samples", &plant.drive.delay_samples,
               "readings from a write to its torque",
               {.low = 0.0, .high = static_cast<double>(kMaxDelaySamples)});
  settings.add(prefix + "watchdog.timeout_ms", &plant.watchdog.timeout_ms,
               "without a write for so long torques are dropped, 0: never", kNotNegative);
  settings.add(prefix + "workspace.stops", &plant.workspace.stops, "the arm has its joint stops");
  settings.add(prefix + "integration.max_step_ms", &plant.integration.max_step_ms,
               "longest step of the integrator", {.low = 0.001, .high = 2.0});
}

std::string place_of(const toml::node& node, const std::string& file) {
  return fmt::format("{}:{}", file, node.source().begin.line);
}

std::string allowed_keys(const Settings& settings) {
  std::string list;
  for (const Setting& setting : settings.list()) {
    list += setting.key + ", ";
  }
  return list + "[[effect]]";
}

std::string text_of(const toml::node& node) {
  if (const auto text = node.value_exact<std::string>()) return *text;
  std::ostringstream out;
  node.visit([&](const auto& value) { out << value; });
  return out.str();
}

EffectSpec effect_of(const toml::table& table, const std::string& file) {
  const std::string place = place_of(table, file);
  EffectSpec effect;
  const auto kind = table["kind"].value_exact<std::string>();
  if (!kind) throw ConfigError{place + ": an effect needs kind = \"...\""};
  effect.kind = *kind;
  for (const auto& [key, node] : table) {
    if (key == "kind") continue;
    if (key == "axis") {
      const auto axis = node.value_exact<std::int64_t>();
      if (!axis || *axis < 1 || *axis > static_cast<std::int64_t>(kJoints)) {
        throw ConfigError{fmt::format("{}: {}: axis = {}: allowed: 1, 2, 3", place_of(node, file),
                                      *kind, text_of(node))};
      }
      effect.axis = static_cast<std::size_t>(*axis - 1);
      continue;
    }
    const auto value = node.value<double>();
    if (!value || !node.is_number()) {
      throw ConfigError{
          fmt::format("{}: {}: {} must be a number", place_of(node, file), *kind, key.str())};
    }
    effect.parameters.emplace(key.str(), *value);
  }
  return effect;
}

/// check(), its message completed by the line of the key that it names, else of the table.
void check_at(const EffectSpec& effect, const toml::table& table, const std::string& file) {
  try {
    check(effect);
  } catch (const ConfigError& error) {
    const std::string_view message = error.what();
    const toml::node* culprit = &table;
    for (const auto& [key, node] : table) {
      const bool named = message.find(fmt::format(": {} = ", key.str())) != message.npos ||
                         message.find(fmt::format("'{}'", key.str())) != message.npos;
      if (named || (key == "kind" && message.starts_with("unknown effect"))) culprit = &node;
    }
    throw ConfigError{fmt::format("{}: {}", place_of(*culprit, file), message)};
  }
}

void read_effects(const toml::node& node, const std::string& file, PlantSpec& plant) {
  const toml::array* array = node.as_array();
  if (array == nullptr || !array->is_homogeneous(toml::node_type::table)) {
    throw ConfigError{place_of(node, file) + ": effects are written as [[effect]] tables"};
  }
  for (const toml::node& each : *array) {
    const toml::table& table = *each.as_table();
    plant.effects.push_back(effect_of(table, file));
    check_at(plant.effects.back(), table, file);
  }
}

void read_settings(const toml::table& table,
                   const std::string& prefix,
                   const std::string& file,
                   Settings& settings) {
  for (const auto& [key, node] : table) {
    const std::string full = prefix + std::string{key.str()};
    if (full == kEffectTables) continue;
    if (const toml::table* inner = node.as_table()) {
      read_settings(*inner, full + '.', file, settings);
      continue;
    }
    const auto& list = settings.list();
    const auto found = std::find_if(list.begin(), list.end(),
                                    [&](const Setting& setting) { return setting.key == full; });
    if (found == list.end()) {
      throw ConfigError{fmt::format("{}: unknown key '{}'; allowed: {}", place_of(node, file), full,
                                    allowed_keys(settings))};
    }
    if (std::holds_alternative<std::string*>(found->target) != node.is_string()) {
      throw ConfigError{fmt::format("{}: {} = {}: wrong type; it looks like {}",
                                    place_of(node, file), full, text_of(node), found->value())};
    }
    settings.set(full, text_of(node), place_of(node, file));
  }
}

}  // namespace

void add_settings(Settings& settings, const std::string& prefix, PlantSpec& plant) {
  add_plain_settings(settings, prefix, plant);
  std::map<std::string, int> seen;
  for (EffectSpec& effect : plant.effects) {
    const std::string axis = effect.axis ? fmt::format(".{}", *effect.axis + 1) : "";
    const int number = ++seen[effect.kind + axis];
    const std::string nth = number > 1 ? fmt::format("_{}", number) : "";
    for (const EffectParameter& parameter : find_effect(effect.kind).parameters) {
      const auto place = effect.parameters.try_emplace(std::string{parameter.name},
                                                       parameter.standard.value_or(0.0));
      settings.add(fmt::format("{}{}.{}{}{}.{}", prefix, kEffectTables, effect.kind, nth, axis,
                               parameter.name),
                   &place.first->second, fmt::format("{}, {}", parameter.text, parameter.unit),
                   parameter.range);
    }
  }
}

PlantSpec parse_plant(std::string_view text, const std::string& file, const std::string& table) {
  toml::table root;
  try {
    root = toml::parse(text, file);
  } catch (const toml::parse_error& error) {
    throw ConfigError{
        fmt::format("{}:{}: not TOML: {}", file, error.source().begin.line, error.description())};
  }
  const toml::table* own = table.empty() ? &root : root[table].as_table();
  if (own == nullptr) throw ConfigError{fmt::format("{}: there is no table [{}]", file, table)};
  PlantSpec plant;
  Settings settings;
  add_plain_settings(settings, "", plant);
  read_settings(*own, "", file, settings);
  if (const toml::node* effects = own->get(kEffectTables)) read_effects(*effects, file, plant);
  return plant;
}

PlantSpec load_plant(const std::string& name) {
  const std::filesystem::path file =
      data_file(name.ends_with(".toml") ? std::filesystem::path{name}
                                        : std::filesystem::path{"plants"} / (name + ".toml"));
  return parse_plant(read_text(file, "plant file"), file.string());
}

std::string to_toml(const PlantSpec& plant) {
  PlantSpec copy = plant;
  Settings settings;
  add_plain_settings(settings, "", copy);
  std::string out;
  std::string table;
  for (const Setting& setting : settings.list()) {
    const std::size_t dot = setting.key.find('.');
    const std::string in_table = dot == std::string::npos ? "" : setting.key.substr(0, dot);
    if (in_table != table) out += fmt::format("\n[{}]\n", in_table);
    table = in_table;
    const std::string key = dot == std::string::npos ? setting.key : setting.key.substr(dot + 1);
    out += fmt::format("{} = {}  # {}\n", key, setting.value(), setting.text);
  }
  for (const EffectSpec& effect : plant.effects) {
    out += fmt::format("\n[[effect]]\nkind = \"{}\"\n", effect.kind);
    if (effect.axis) out += fmt::format("axis = {}\n", *effect.axis + 1);
    for (const auto& [name, value] : effect.parameters) {
      out += fmt::format("{} = {}\n", name, value);
    }
  }
  return out;
}

}  // namespace teleop
