#include "core/experiment/scenario.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include <fmt/format.h>
#include <toml++/toml.h>

#include "core/base/error.hpp"
#include "core/effects/text_file.hpp"
#include "core/effects/vocabulary.hpp"
#include "core/simulation/plant.hpp"

namespace teleop {
namespace {

toml::table parse(const ScenarioText& text) {
  try {
    return toml::parse(text.toml, text.file);
  } catch (const toml::parse_error& error) {
    throw ConfigError{fmt::format("{}:{}: not TOML: {}", text.file, error.source().begin.line,
                                  error.description())};
  }
}

const Override* last_of(const std::vector<Override>& overrides, std::string_view key) {
  const auto found = std::find_if(overrides.rbegin(), overrides.rend(),
                                  [&](const Override& each) { return each.key == key; });
  return found == overrides.rend() ? nullptr : &*found;
}

/// Runs `read`; what it refuses is said to be at `place`.
template <class Read>
auto at_place(const std::string& place, Read&& read) {
  try {
    return read();
  } catch (const ConfigError& error) {
    throw ConfigError{fmt::format("{}: {}", place, error.what())};
  }
}

std::string place_of(const toml::node& node, const std::string& file) {
  return fmt::format("{}:{}", file, node.source().begin.line);
}

/// The plant that a scenario names or holds; none when it says nothing of it.
std::optional<PlantSpec> plant_of(const ScenarioText& text,
                                  const toml::table& root,
                                  const std::string& key,
                                  const std::vector<Override>& overrides) {
  if (const Override* other = last_of(overrides, key)) {
    return at_place(other->origin, [&] { return load_plant(other->value); });
  }
  const toml::node* node = root.get(key);
  if (node == nullptr) return std::nullopt;
  if (node->is_table()) return parse_plant(text.toml, text.file, key);
  const std::string place = place_of(*node, text.file);
  const auto name = node->value_exact<std::string>();
  if (!name) {
    throw ConfigError{
        fmt::format("{}: {}: must be the name of a plant in quotes or a table", place, key)};
  }
  return at_place(place, [&] { return load_plant(*name); });
}

/// What other readers than the list of settings take: the sweep, effects, and plants that are named
/// or replaced instead of written out.
std::vector<std::string_view> others_in(const toml::table& root,
                                        const std::vector<Override>& overrides) {
  std::vector<std::string_view> others{"sweep", "plant.effect", "slave_plant.effect"};
  for (const char* key : {"plant", "slave_plant"}) {
    if (!root[key].is_table() || last_of(overrides, key) != nullptr) others.emplace_back(key);
  }
  return others;
}

}  // namespace

ScenarioText read_scenario(const std::string& name) {
  namespace fs = std::filesystem;
  const fs::path file = data_file(
      name.ends_with(".toml") ? fs::path{name} : fs::path{"catalogue"} / (name + ".toml"));
  return {.toml = read_text(file, "scenario"), .file = file.string()};
}

Scenario::Scenario(const ScenarioText& text, const std::vector<Override>& overrides) {
  choose_experiment(text, overrides);
  choose_plants(text, overrides);

  settings_.add("experiment", &experiment_name_, "what is done");
  settings_.add("name", &name_, "of the scenario, free text");
  settings_.add("text", &text_, "what it shows, one line");
  settings_.add("seed", &seed_, "of everything random", kNotNegative);
  settings_.add("device", &device_, "\"sim\": the plant below on simulated time; else an arm");
  experiment_->add_settings(settings_);
  add_settings(settings_, "plant.", plant_);
  if (slave_has_own_) add_settings(settings_, "slave_plant.", slave_plant_);

  settings_.load_text(text.toml, text.file, others_in(parse(text), overrides));
  for (const Override& each : overrides) {
    if (each.key == "plant" || each.key == "slave_plant") continue;
    settings_.set(each.key, each.value, each.origin);
  }
  if (!slave_has_own_) slave_plant_ = plant_;
  if (!simulated() && !kind_->hardware) {
    refuse("device", fmt::format("the experiment {} runs on simulated arms alone", kind_->name));
  }
  experiment_->check(*this);
}

void Scenario::choose_experiment(const ScenarioText& text, const std::vector<Override>& overrides) {
  if (const Override* other = last_of(overrides, "experiment")) {
    kind_ = at_place(other->origin, [&] { return &find_experiment(other->value); });
  } else {
    const toml::table root = parse(text);
    const toml::node* node = root.get("experiment");
    const auto name = node == nullptr ? std::nullopt : node->value_exact<std::string>();
    if (!name) {
      throw ConfigError{
          fmt::format("{}: a scenario needs experiment = \"...\" outside any table", text.file)};
    }
    kind_ = at_place(place_of(*node, text.file), [&] { return &find_experiment(*name); });
  }
  experiment_name_ = kind_->name;
  experiment_ = kind_->make();
}

void Scenario::choose_plants(const ScenarioText& text, const std::vector<Override>& overrides) {
  const toml::table root = parse(text);
  if (kind_->arms < 2) {
    const Override* other = last_of(overrides, "slave_plant");
    const toml::node* node = root.get("slave_plant");
    if (node != nullptr || other != nullptr) {
      throw ConfigError{fmt::format("{}: unknown key 'slave_plant'; the experiment {} has one arm",
                                    other != nullptr ? other->origin : place_of(*node, text.file),
                                    kind_->name)};
    }
  }
  const auto plant = plant_of(text, root, "plant", overrides);
  plant_ = plant ? *plant : load_plant("phantom-1.5");
  const auto slave = plant_of(text, root, "slave_plant", overrides);
  slave_has_own_ = slave.has_value();
  if (slave) slave_plant_ = *slave;
}

void Scenario::refuse(const std::string& key, const std::string& why) const {
  for (const Setting& setting : settings_.list()) {
    if (setting.key == key) {
      throw ConfigError{fmt::format("{}: {} = {}: {}", setting.origin, key, setting.value(), why)};
    }
  }
  throw ConfigError{fmt::format("{}: {}", key, why)};
}

void check_integrator(const Scenario& scenario,
                      const PlantSpec& plant,
                      const std::string& prefix,
                      const Surroundings& surroundings) {
  constexpr double kStableOnTheRealAxis = 2.785;
  const Plant made{load_arm(plant.arm),
                   {.terms = terms_of(plant.effects),
                    .hand = surroundings.hand,
                    .contact = surroundings.contact}};
  const double fastest = made.fastest_rate();
  const double step_s = 1e-3 * plant.integration.max_step_ms;
  if (step_s * fastest <= kStableOnTheRealAxis) return;
  scenario.refuse(
      prefix + "integration.max_step_ms",
      fmt::format("unstable: effects, hand or surface act at up to {:.4g} 1/s; at most {:.3g}",
                  fastest, 1e3 * kStableOnTheRealAxis / fastest));
}

}  // namespace teleop
