#include "core/experiment/sweep_axis.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <initializer_list>
#include <sstream>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>
#include <toml++/toml.h>

#include "core/base/error.hpp"

namespace teleop {
namespace {

constexpr std::int64_t kMostPoints = 1'000'000;

/// One table of the file, with the manner of its refusals.
class Table {
 public:
  Table(const toml::table& table, std::string name, const std::string& file)
      : table_{table}, name_{std::move(name)}, file_{file} {}

  [[nodiscard]] std::string place(const toml::node& node) const {
    return fmt::format("{}:{}", file_, node.source().begin.line);
  }
  [[nodiscard]] std::string place() const { return place(table_); }

  [[noreturn]] void refuse(const toml::node& node, const std::string& why) const {
    throw ConfigError{fmt::format("{}: {}", place(node), why)};
  }
  [[noreturn]] void refuse(const std::string& why) const { refuse(table_, name_ + ": " + why); }

  void allow(std::initializer_list<std::string_view> keys) const {
    for (const auto& [key, node] : table_) {
      if (std::find(keys.begin(), keys.end(), key.str()) == keys.end()) {
        refuse(node, fmt::format("unknown key '{}.{}'; allowed: {}", name_, key.str(),
                                 fmt::join(keys, ", ")));
      }
    }
  }

  [[nodiscard]] const toml::node* get(std::string_view key) const { return table_.get(key); }

  [[nodiscard]] std::optional<double> number(std::string_view key) const {
    const toml::node* node = get(key);
    if (node == nullptr) return std::nullopt;
    const auto value = node->value<double>();
    if (!node->is_number() || !value || !std::isfinite(*value)) {
      refuse(*node, fmt::format("{}.{}: must be a number", name_, key));
    }
    return value;
  }

  [[nodiscard]] std::optional<std::int64_t> whole(std::string_view key, std::int64_t low) const {
    const toml::node* node = get(key);
    if (node == nullptr) return std::nullopt;
    const auto value = node->value_exact<std::int64_t>();
    if (!value || *value < low || *value > kMostPoints) {
      refuse(*node, fmt::format("{}.{}: must be a whole number from {} to {}", name_, key, low,
                                kMostPoints));
    }
    return value;
  }

  /// One of a few words; the first where the key is not there.
  [[nodiscard]] std::size_t choice(std::string_view key,
                                   std::initializer_list<std::string_view> words) const {
    const toml::node* node = get(key);
    if (node == nullptr) return 0;
    const auto text = node->value_exact<std::string>();
    const auto* found = text ? std::find(words.begin(), words.end(), *text) : words.end();
    if (found == words.end()) {
      refuse(*node, fmt::format("{}.{}: must be one of {}", name_, key, fmt::join(words, ", ")));
    }
    return static_cast<std::size_t>(found - words.begin());
  }

 private:
  const toml::table& table_;
  std::string name_;
  const std::string& file_;
};

SweepValue value_of(const toml::node& node, const Table& table) {
  if (const auto text = node.value_exact<std::string>()) {
    return {.toml = *text, .json = nlohmann::json(*text).dump()};
  }
  if (node.is_table()) table.refuse(node, "sweep.axis.values: a value cannot be a table");
  std::ostringstream out;
  node.visit([&](const auto& value) { out << value; });
  const std::string text = out.str();
  if (node.is_number()) return {.toml = text, .json = sweep_value(node.value_or(0.0)).json};
  const bool plain = node.is_boolean();
  return {.toml = text, .json = plain ? text : nlohmann::json(text).dump()};
}

std::vector<std::string> keys_of(const Table& table) {
  const toml::node* one = table.get("key");
  const toml::node* many = table.get("keys");
  if ((one != nullptr) == (many != nullptr)) {
    table.refuse("needs either key = \"...\" or keys = [\"...\", \"...\"]");
  }
  std::vector<std::string> keys;
  if (one != nullptr) {
    if (!one->is_string()) table.refuse(*one, "sweep.axis.key: must be text in quotes");
    return {one->value_or(std::string{})};
  }
  const toml::array* list = many->as_array();
  if (list == nullptr || list->empty() || !list->is_homogeneous(toml::node_type::string)) {
    table.refuse(*many, "sweep.axis.keys: must be a list of texts in quotes");
  }
  for (const toml::node& each : *list) {
    keys.push_back(each.value_or(std::string{}));
  }
  return keys;
}

void read_range(const Table& table, SweepTable::Axis& axis) {
  const auto from = table.number("from");
  const auto to = table.number("to");
  if (!from || !to) table.refuse("needs values = [...], or from and to");
  if (!(*from < *to)) {
    table.refuse(*table.get("to"), fmt::format("sweep.axis: the range from {} to {} has no room; "
                                               "`from` must be below `to`",
                                               *from, *to));
  }
  if (axis.axis.logarithmic && *from <= 0.0) {
    table.refuse(
        *table.get("from"),
        fmt::format("sweep.axis.from = {}: must be more than 0 where spacing is log", *from));
  }
  axis.range = true;
  axis.from = *from;
  axis.to = *to;
  axis.points = table.whole("points", 2).value_or(0);
}

SweepTable::Axis axis_of(const Table& table) {
  table.allow({"key", "keys", "values", "from", "to", "points", "spacing"});
  SweepTable::Axis axis;
  axis.axis.place = table.place();
  axis.axis.keys = keys_of(table);
  axis.axis.logarithmic = table.choice("spacing", {"linear", "log"}) == 1;
  const toml::node* values = table.get("values");
  if (values == nullptr) {
    read_range(table, axis);
    return axis;
  }
  for (const char* other : {"from", "to", "points"}) {
    if (const toml::node* node = table.get(other)) {
      table.refuse(*node, fmt::format("sweep.axis: `{}` and `values` exclude each other", other));
    }
  }
  const toml::array* list = values->as_array();
  if (list == nullptr) table.refuse(*values, "sweep.axis.values: must be a list");
  if (list->empty()) table.refuse(*values, "sweep.axis.values: the list is empty");
  for (const toml::node& each : *list) {
    axis.axis.values.push_back(value_of(each, table));
  }
  return axis;
}

SweepRest rest_of(const Table& table) {
  table.allow({"max_temperature_C", "pause_s", "timeout_s"});
  SweepRest rest;
  rest.max_temperature_C = table.number("max_temperature_C").value_or(rest.max_temperature_C);
  rest.pause_s = table.number("pause_s").value_or(rest.pause_s);
  rest.timeout_s = table.number("timeout_s").value_or(rest.timeout_s);
  if (rest.pause_s < 0.0 || rest.timeout_s <= rest.pause_s) {
    table.refuse("pause_s must be 0 or more and timeout_s longer than it");
  }
  return rest;
}

}  // namespace

SweepTable read_sweep_table(const ScenarioText& text) {
  toml::table root;
  try {
    root = toml::parse(text.toml, text.file);
  } catch (const toml::parse_error& error) {
    throw ConfigError{fmt::format("{}:{}: not TOML: {}", text.file, error.source().begin.line,
                                  error.description())};
  }
  const toml::table* own = root["sweep"].as_table();
  if (own == nullptr) {
    throw ConfigError{fmt::format("{}: there is no [sweep] table; teleop run runs it", text.file)};
  }
  const Table table{*own, "sweep", text.file};
  table.allow({"method", "points", "seed", "seeds", "axis", "rest"});
  SweepTable sweep;
  sweep.place = table.place();
  sweep.method =
      static_cast<SweepPlan::Method>(table.choice("method", {"grid", "list", "latin_hypercube"}));
  sweep.points = table.whole("points", 1).value_or(0);
  sweep.seed = static_cast<std::uint64_t>(table.whole("seed", 0).value_or(1));
  sweep.same_seed = table.choice("seeds", {"own", "same"}) == 1;
  const toml::array* axes = own->get("axis") != nullptr ? own->get("axis")->as_array() : nullptr;
  if (axes == nullptr || axes->empty() || !axes->is_homogeneous(toml::node_type::table)) {
    table.refuse("what is swept is written as [[sweep.axis]] tables");
  }
  for (const toml::node& each : *axes) {
    sweep.axes.push_back(axis_of({*each.as_table(), "sweep.axis", text.file}));
  }
  if (const toml::node* rest = own->get("rest")) {
    if (!rest->is_table()) table.refuse(*rest, "sweep.rest is a table");
    sweep.rest = rest_of({*rest->as_table(), "sweep.rest", text.file});
  }
  return sweep;
}

double at_share(const SweepTable::Axis& axis, double u) {
  if (u <= 0.0) return axis.from;
  if (u >= 1.0) return axis.to;
  const double value = axis.axis.logarithmic ? axis.from * std::pow(axis.to / axis.from, u)
                                             : axis.from + u * (axis.to - axis.from);
  // Ten digits are plenty and keep 0.30000000000000004 out of tables.
  return std::stod(fmt::format("{:.10g}", value));
}

SweepValue sweep_value(double number) {
  const std::string text = fmt::format("{}", number);
  return {.toml = text, .json = text};
}

}  // namespace teleop
