#include "core/base/settings.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <sstream>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <toml++/toml.h>

#include "core/base/contract.hpp"
#include "core/base/error.hpp"

namespace teleop {
namespace {

namespace fs = std::filesystem;

std::string place_of(const toml::node& node, const std::string& name) {
  const auto line = node.source().begin.line;
  return line > 0 ? fmt::format("{}:{}", name, line) : name;
}

std::string range_text(const Range& range) {
  if (std::isinf(range.high)) {
    return range.low == 0.0     ? "0 or more"
           : range.low < 1e-300 ? "more than 0"
                                : fmt::format("at least {}", range.low);
  }
  if (std::isinf(range.low)) return fmt::format("at most {}", range.high);
  return fmt::format("between {} and {}", range.low, range.high);
}

double checked(double value, const Setting& setting, const std::string& place) {
  if (!std::isfinite(value) || value < setting.range.low || value > setting.range.high) {
    throw ConfigError{fmt::format("{}: {} = {}: must be {}", place, setting.key, value,
                                  range_text(setting.range))};
  }
  return value;
}

[[noreturn]] void wrong_type(const Setting& setting,
                             const std::string& place,
                             std::string_view wanted) {
  throw ConfigError{fmt::format("{}: {}: must be {}", place, setting.key, wanted)};
}

/// Stores a TOML value in whatever the setting is bound to.
class Store {
 public:
  Store(const toml::node& node, const Setting& setting, const std::string& place)
      : node_{node}, setting_{setting}, place_{place} {}

  void operator()(bool* target) const {
    const auto value = node_.value_exact<bool>();
    if (!value) wrong_type(setting_, place_, "true or false");
    *target = *value;
  }
  void operator()(int* target) const { *target = static_cast<int>(whole()); }
  void operator()(std::uint64_t* target) const { *target = static_cast<std::uint64_t>(whole()); }
  void operator()(double* target) const { *target = real(node_); }
  void operator()(std::string* target) const {
    const auto value = node_.value_exact<std::string>();
    if (!value) wrong_type(setting_, place_, "text in quotes");
    *target = *value;
  }
  void operator()(std::array<double, 3>* target) const {
    const toml::array* array = node_.as_array();
    if (array == nullptr || array->size() != 3) wrong_type(setting_, place_, "a list of 3 numbers");
    std::array<double, 3> values{};
    for (std::size_t i = 0; i < 3; ++i) {
      values.at(i) = real((*array)[i]);
    }
    *target = values;
  }

 private:
  [[nodiscard]] std::int64_t whole() const {
    const auto value = node_.value_exact<std::int64_t>();
    if (!value) wrong_type(setting_, place_, "a whole number");
    checked(static_cast<double>(*value), setting_, place_);
    return *value;
  }
  [[nodiscard]] double real(const toml::node& node) const {
    const auto value = node.value<double>();
    if (!value || node.is_boolean()) wrong_type(setting_, place_, "a number");
    return checked(*value, setting_, place_);
  }

  const toml::node& node_;
  const Setting& setting_;
  const std::string& place_;
};

/// The closest known key, for a mistyped one.
std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  for (std::size_t j = 0; j < row.size(); ++j) {
    row[j] = j;
  }
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t diagonal = row[0]++;
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::size_t above = row[j + 1];
      row[j + 1] = std::min({row[j] + 1, above + 1, diagonal + (a[i] == b[j] ? 0U : 1U)});
      diagonal = above;
    }
  }
  return row[b.size()];
}

/// What could have stood in place of an unknown key: the keys of its table; where there is no such
/// table, the tables and the keys outside any.
std::string allowed_instead(const std::vector<Setting>& settings, const std::string& key) {
  const std::string table = key.substr(0, key.rfind('.') + 1);
  std::vector<std::string> names;
  for (const Setting& setting : settings) {
    const bool same = table.size() < setting.key.size() && setting.key.starts_with(table) &&
                      setting.key.find('.', table.size()) == std::string::npos;
    if (same) names.push_back(setting.key);
  }
  if (!names.empty() && !table.empty()) return fmt::format("{}", fmt::join(names, ", "));
  names.clear();
  for (const Setting& setting : settings) {
    const std::size_t dot = setting.key.find('.');
    const std::string name =
        dot == std::string::npos ? setting.key : fmt::format("[{}]", setting.key.substr(0, dot));
    if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
  }
  return fmt::format("{}", fmt::join(names, ", "));
}

struct Printer {
  std::string operator()(const bool* value) const { return *value ? "true" : "false"; }
  std::string operator()(const int* value) const { return std::to_string(*value); }
  std::string operator()(const std::uint64_t* value) const { return std::to_string(*value); }
  std::string operator()(const double* value) const {
    std::string text = fmt::format("{}", *value);
    return text.find_first_of(".en") == std::string::npos ? text + ".0" : text;
  }
  std::string operator()(const std::string* value) const {
    std::ostringstream out;
    out << toml::value<std::string>{*value};
    return out.str();
  }
  std::string operator()(const std::array<double, 3>* value) const {
    return fmt::format("[{}, {}, {}]", (*this)(&(*value)[0]), (*this)(&(*value)[1]),
                       (*this)(&(*value)[2]));
  }
};

}  // namespace

std::string Setting::value() const { return std::visit(Printer{}, target); }

void Settings::add(std::string key, Setting::Target target, std::string text, Range range) {
  const bool is_new = std::none_of(settings_.begin(), settings_.end(),
                                   [&](const Setting& other) { return other.key == key; });
  expects(is_new, "a setting is added once");
  settings_.push_back(
      {.key = std::move(key), .text = std::move(text), .target = target, .range = range});
}

Setting& Settings::find(const std::string& key, const std::string& place) {
  for (Setting& setting : settings_) {
    if (setting.key == key) return setting;
  }
  const Setting* closest = nullptr;
  std::size_t best = 4;
  for (const Setting& setting : settings_) {
    const std::size_t distance = edit_distance(setting.key, key);
    if (distance < best) {
      best = distance;
      closest = &setting;
    }
  }
  throw ConfigError{fmt::format("{}: unknown key '{}'; {}", place, key,
                                closest == nullptr
                                    ? "allowed: " + allowed_instead(settings_, key)
                                    : fmt::format("did you mean '{}'?", closest->key))};
}

void Settings::load(const fs::path& file) {
  std::error_code error;
  if (!fs::is_regular_file(file, error)) {
    throw ConfigError{fmt::format("{}: no such file", file.string())};
  }
  std::ifstream in{file, std::ios::binary};
  std::ostringstream text;
  text << in.rdbuf();
  if (!in) {
    throw ConfigError{fmt::format("{}: cannot be read", file.string())};
  }
  load_text(text.str(), file.string());
}

void Settings::load_text(std::string_view text,
                         const std::string& name,
                         std::span<const std::string_view> others) {
  toml::table root;
  try {
    root = toml::parse(text, name);
  } catch (const toml::parse_error& error) {
    throw ConfigError{
        fmt::format("{}:{}: not TOML: {}", name, error.source().begin.line, error.description())};
  }
  const auto walk = [&](const auto& self, const toml::table& table,
                        const std::string& prefix) -> void {
    for (const auto& [key, node] : table) {
      const std::string full =
          prefix.empty() ? std::string{key.str()} : prefix + '.' + std::string{key.str()};
      if (std::find(others.begin(), others.end(), full) != others.end()) continue;
      if (const toml::table* inner = node.as_table()) {
        self(self, *inner, full);
        continue;
      }
      const std::string place = place_of(node, name);
      Setting& setting = find(full, place);
      std::visit(Store{node, setting, place}, setting.target);
      setting.origin = place;
    }
  };
  walk(walk, root, "");
}

void Settings::set(const std::string& key, const std::string& text, const std::string& origin) {
  Setting& setting = find(key, origin);
  if (auto* const* target = std::get_if<std::string*>(&setting.target)) {
    **target = text;
    setting.origin = origin;
    return;
  }
  try {
    const toml::table table = toml::parse("value = " + text);
    std::visit(Store{*table.get("value"), setting, origin}, setting.target);
  } catch (const toml::parse_error&) {
    throw ConfigError{fmt::format("{}: {} = {}: not a value", origin, key, text)};
  }
  setting.origin = origin;
}

std::string Settings::print() const {
  const auto table_of = [](const Setting& setting) {
    const std::size_t dot = setting.key.rfind('.');
    return dot == std::string::npos ? std::string{} : setting.key.substr(0, dot);
  };
  std::vector<std::string> tables{""};  // TOML wants the keys outside any table first
  for (const Setting& setting : settings_) {
    const std::string table = table_of(setting);
    if (std::find(tables.begin(), tables.end(), table) == tables.end()) tables.push_back(table);
  }
  std::string out;
  for (const std::string& table : tables) {
    if (!table.empty()) out += fmt::format("\n[{}]\n", table);
    for (const Setting& setting : settings_) {
      if (table_of(setting) != table) continue;
      const std::string name = setting.key.substr(table.empty() ? 0 : table.size() + 1);
      out += fmt::format("{:<44} # {} ({})\n", fmt::format("{} = {}", name, setting.value()),
                         setting.text, setting.origin);
    }
  }
  return out;
}

fs::path data_file(const fs::path& name) {
  std::error_code error;
  if (fs::exists(name, error)) return name;
  std::vector<fs::path> places;
  // NOLINTNEXTLINE(concurrency-mt-unsafe): read before any thread is started
  if (const char* folder = std::getenv("TELEOP_DATA")) places.emplace_back(folder);
  const fs::path program = fs::read_symlink("/proc/self/exe", error);
  if (!error) places.push_back(program.parent_path().parent_path() / "share" / "teleop");
  places.emplace_back(TELEOP_DATA_DIR);
  std::string looked;
  for (const fs::path& place : places) {
    if (fs::exists(place / name, error)) return place / name;
    looked += (looked.empty() ? "" : ", ") + place.string();
  }
  throw ConfigError{fmt::format("{}: no such file, nor in {}", name.string(), looked)};
}

}  // namespace teleop
