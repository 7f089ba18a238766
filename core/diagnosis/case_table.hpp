#pragma once

#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include <toml++/toml.h>

#include "core/base/settings.hpp"

namespace teleop {

/// A table of a case file that is read key by key and then asked for keys that nobody wanted.
/// Every function throws ConfigError naming file, line and key.
class CaseTable {
 public:
  /// The table and the name of its file must outlive it.
  CaseTable(const toml::table& table, const std::string& file) : table_{table}, file_{file} {}

  [[nodiscard]] bool has(std::string_view key) const { return table_.contains(key); }

  [[nodiscard]] std::string text(const std::string& key);  ///< has to be there
  [[nodiscard]] std::string text(const std::string& key, const std::string& otherwise);
  [[nodiscard]] std::optional<double> number(const std::string& key, Range range = kAny);
  [[nodiscard]] bool flag(const std::string& key, bool otherwise);
  [[nodiscard]] std::vector<double> numbers(const std::string& key, std::size_t size, Range range);

  /// A number, { value = number, tolerance = number } or the word "free".
  struct Quantity {
    std::optional<double> value{};  ///< none: free
    double tolerance = 0.0;         ///< as a share of the value
    bool stated = false;            ///< the tolerance
  };
  [[nodiscard]] Quantity quantity(const std::string& key, Range range = kAny);

  /// The tables written as [[key]]; none when there is no such key.
  [[nodiscard]] std::vector<CaseTable> tables(const std::string& key);
  /// A table written as { … } below a key that may also hold a word: nothing when it does.
  [[nodiscard]] std::optional<CaseTable> table(const std::string& key);

  /// @throws ConfigError for a key that was not asked for.
  void refuse_others() const;

  /// "case.toml:7", of a key or of the table.
  [[nodiscard]] std::string place(const std::string& key = {}) const;

 private:
  [[nodiscard]] const toml::node* find(const std::string& key);
  [[nodiscard]] double checked(const toml::node& node, const std::string& key, Range range) const;
  [[noreturn]] void refuse(const std::string& key, std::string_view wanted) const;

  const toml::table& table_;
  const std::string& file_;
  std::set<std::string> asked_{};
};

}  // namespace teleop
