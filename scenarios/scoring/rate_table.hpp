#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "scenarios/scoring/rates.hpp"

namespace teleop {

/// Somebody whose answers were scored.
struct Contestant {
  std::string name{};
  Rates rates{};
};

/// A table as text: a head line and rows of as many cells.
struct TextTable {
  std::string title{};
  std::vector<std::vector<std::string>> rows{};  ///< the first is the head
};

/// The figures of a campaign side by side, with what is aimed at; then the same kind by kind.
[[nodiscard]] std::vector<TextTable> tables_of(const std::vector<Contestant>& contestants);

enum class TableStyle : std::uint8_t { plain, markdown };
[[nodiscard]] std::string text_of(const TextTable& table, TableStyle style);

/// The figures of one contestant as scripts read them: rates as counts, with n and bounds.
[[nodiscard]] nlohmann::ordered_json json_of(const Rates& rates);

}  // namespace teleop
