#include "core/diagnosis/case_table.hpp"

#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "core/base/error.hpp"

namespace teleop {

const toml::node* CaseTable::find(const std::string& key) {
  asked_.insert(key);
  return table_.get(key);
}

std::string CaseTable::place(const std::string& key) const {
  const toml::node* node = key.empty() ? nullptr : table_.get(key);
  const auto line = (node != nullptr ? node->source() : table_.source()).begin.line;
  return line > 0 ? fmt::format("{}:{}", file_, line) : file_;
}

void CaseTable::refuse(const std::string& key, std::string_view wanted) const {
  throw ConfigError{fmt::format("{}: {} must be {}", place(key), key, wanted)};
}

std::string CaseTable::text(const std::string& key) {
  const toml::node* node = find(key);
  if (node == nullptr) {
    throw ConfigError{fmt::format("{}: {} is missing; add {} = \"...\"", place(), key, key)};
  }
  const auto value = node->value_exact<std::string>();
  if (!value || value->empty()) refuse(key, "text in quotes");
  return *value;
}

std::string CaseTable::text(const std::string& key, const std::string& otherwise) {
  asked_.insert(key);
  return has(key) ? text(key) : otherwise;
}

double CaseTable::checked(const toml::node& node, const std::string& key, Range range) const {
  const auto value = node.value<double>();
  if (!value || !node.is_number()) refuse(key, "a number");
  if (!std::isfinite(*value) || *value < range.low || *value > range.high) {
    refuse(key, range.low > 0.0 ? "more than 0" : range.low == 0.0 ? "0 or more" : "finite");
  }
  return *value;
}

std::optional<double> CaseTable::number(const std::string& key, Range range) {
  const toml::node* node = find(key);
  if (node == nullptr) return std::nullopt;
  return checked(*node, key, range);
}

bool CaseTable::flag(const std::string& key, bool otherwise) {
  const toml::node* node = find(key);
  if (node == nullptr) return otherwise;
  const auto value = node->value_exact<bool>();
  if (!value) refuse(key, "true or false");
  return *value;
}

std::vector<double> CaseTable::numbers(const std::string& key, std::size_t size, Range range) {
  const toml::node* node = find(key);
  if (node == nullptr) return {};
  const toml::array* array = node->as_array();
  if (array == nullptr || array->size() != size) refuse(key, fmt::format("{} numbers", size));
  std::vector<double> values;
  values.reserve(size);
  for (const toml::node& each : *array) {
    values.push_back(checked(each, key, range));
  }
  return values;
}

CaseTable::Quantity CaseTable::quantity(const std::string& key, Range range) {
  constexpr std::string_view kForms = "a number, { value = 1.0, tolerance = 0.1 } or \"free\"";
  const toml::node* node = find(key);
  if (node == nullptr) {
    throw ConfigError{fmt::format("{}: {} is missing; it is {}", place(), key, kForms)};
  }
  if (node->is_number()) return {.value = checked(*node, key, range)};
  if (node->is_string() && node->value<std::string>() == "free") return {};
  const toml::table* inner = node->as_table();
  if (inner == nullptr) refuse(key, kForms);
  CaseTable both{*inner, file_};
  const auto value = both.number("value", range);
  const auto tolerance = both.number("tolerance", kNotNegative);
  both.refuse_others();
  if (!value) refuse(key, kForms);
  return {.value = value, .tolerance = tolerance.value_or(0.0), .stated = tolerance.has_value()};
}

std::vector<CaseTable> CaseTable::tables(const std::string& key) {
  std::vector<CaseTable> all;
  const toml::node* node = find(key);
  if (node == nullptr) return all;
  const toml::array* array = node->as_array();
  if (array == nullptr || !array->is_homogeneous(toml::node_type::table)) {
    refuse(key, fmt::format("written as [[{}]] tables", key));
  }
  all.reserve(array->size());
  for (const toml::node& each : *array) {
    all.emplace_back(*each.as_table(), file_);
  }
  return all;
}

std::optional<CaseTable> CaseTable::table(const std::string& key) {
  const toml::node* node = find(key);
  if (node == nullptr || !node->is_table()) return std::nullopt;
  return CaseTable{*node->as_table(), file_};
}

void CaseTable::refuse_others() const {
  for (const auto& [key, node] : table_) {
    const std::string name{key.str()};
    if (asked_.contains(name)) continue;
    throw ConfigError{fmt::format("{}: unknown key '{}'; allowed: {}", place(name), name,
                                  fmt::join(asked_, ", "))};
  }
}

}  // namespace teleop
