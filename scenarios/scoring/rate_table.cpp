#include "scenarios/scoring/rate_table.hpp"

#include <algorithm>
#include <array>
#include <functional>
#include <set>
#include <utility>

#include <fmt/format.h>

namespace teleop {
namespace {

/// "1/33, 3.0 % (≤ 13.6 %)".
std::string upper(const Rate& rate) {
  if (rate.n == 0) return "–";
  return fmt::format("{}/{}, {:.1f} % (≤ {:.1f} %)", rate.k, rate.n,
                     100.0 * rate.value().value_or(0.0), 100.0 * rate.upper95());
}

std::string lower(const Rate& rate) {
  if (rate.n == 0) return "–";
  return fmt::format("{}/{}, {:.1f} % (≥ {:.1f} %)", rate.k, rate.n,
                     100.0 * rate.value().value_or(0.0), 100.0 * rate.lower95());
}

std::string percent(const Spread& spread) {
  if (spread.n == 0) return "–";
  return fmt::format("{:.2g} / {:.2g} % (n = {})", 100.0 * spread.median, 100.0 * spread.p90,
                     spread.n);
}

std::string ratio(const Spread& spread) {
  if (spread.n == 0) return "–";
  return fmt::format("{:.4g} / {:.4g} (n = {})", spread.median, spread.p90, spread.n);
}

std::string calibration(const Calibration& calibration) {
  if (calibration.n == 0) return "–";
  return fmt::format("{:.3f} / {:.3f} (n = {})", calibration.ece, calibration.brier, calibration.n);
}

using Cell = std::function<std::string(const Rates&)>;

struct Row {
  std::string name{};
  std::string aim{};
  Cell cell{};
};

Cell at_least(Rate Rates::* part) {
  return [part](const Rates& rates) {
    return lower(rates.*part);
  };
}

Cell at_most(Rate Rates::* part) {
  return [part](const Rates& rates) {
    return upper(rates.*part);
  };
}

Cell at_least(std::size_t band, Rate BandRates::* part) {
  return [band, part](const Rates& rates) {
    return lower(rates.bands.at(band).*part);
  };
}

Cell at_most(std::size_t band, Rate BandRates::* part) {
  return [band, part](const Rates& rates) {
    return upper(rates.bands.at(band).*part);
  };
}

void add_bands(std::vector<Row>& rows) {
  constexpr std::array kNames{"DNR ≥ 10 %", "DNR 2–10 %", "DNR < 2 %"};
  constexpr std::array kRight{"≥ 95 %", "≥ 90 %", ""};
  constexpr std::array kWrong{"", "", "≤ 3 %"};
  for (std::size_t i = 0; i < kNames.size(); ++i) {
    const std::string band = kNames.at(i);
    rows.push_back({"one effect, " + band + ": right name and axis", kRight.at(i),
                    at_least(i, &BandRates::right)});
    rows.push_back({band + ": truth in the stated set", "", at_least(i, &BandRates::in_set)});
    rows.push_back({band + ": a wrong name", kWrong.at(i), at_most(i, &BandRates::wrong_name)});
    rows.push_back({band + ": nothing named", "", at_most(i, &BandRates::silent)});
    rows.push_back({band + ": right axis", "", at_least(i, &BandRates::axis)});
    rows.push_back({band + ": right channel", "", at_least(i, &BandRates::channel)});
  }
}

void add_others(std::vector<Row>& rows) {
  const std::vector<Row> others{
      {"two effects: exactly right", "≥ 80 %", at_least(&Rates::pairs_exact)},
      {"two effects: at least one", "", at_least(&Rates::pairs_any)},
      {"two effects: a wrong name", "", at_most(&Rates::pairs_wrong_name)},
      {"outside the vocabulary: flagged", "≥ 90 %", at_least(&Rates::flagged)},
      {"outside the vocabulary: misnamed", "≤ 5 %", at_most(&Rates::misnamed)},
      {"explicable: flagged", "≤ 5 %", at_most(&Rates::false_flags)},
      {"parameter error, DNR ≥ 2 %: median / 90th percentile", "≤ 2 % / –",
       [](const Rates& rates) {
         return percent(rates.parameter_error);
       }},
      {"90 % intervals cover, DNR ≥ 2 %", "85–95 %", at_least(&Rates::covered)},
      {"90 % intervals cover, all", "", at_least(&Rates::covered_all)},
      {"run held back, RMS over that of the true model: median / 90th percentile", "≤ 1.05 / –",
       [](const Rates& rates) {
         return ratio(rates.held_out);
       }},
      {"RMS over the noise floor, as the answer says: median / 90th percentile", "",
       [](const Rates& rates) {
         return ratio(rates.over_floor);
       }},
      {"confidences: calibration error / Brier score", "≤ 0.03 / –",
       [](const Rates& rates) {
         return calibration(rates.calibration);
       }},
      {"no answer", "0", at_most(&Rates::missing)},
  };
  rows.insert(rows.end(), others.begin(), others.end());
}

TextTable figures(const std::vector<Contestant>& contestants) {
  TextTable table{.title = "Figures", .rows = {{"figure", "aim"}}};
  for (const Contestant& each : contestants) {
    table.rows.front().push_back(each.name);
  }
  std::vector<Row> rows{
      {"no effect: false discovery", "≤ 1 %", at_most(&Rates::false_discoveries)}};
  add_bands(rows);
  add_others(rows);
  for (const Row& row : rows) {
    std::vector<std::string> cells{row.name, row.aim};
    bool empty = true;
    for (const Contestant& each : contestants) {
      cells.push_back(row.cell(each.rates));
      empty = empty && cells.back() == "–";
    }
    if (!empty) table.rows.push_back(std::move(cells));
  }
  return table;
}

using RatesByName = std::map<std::string, Rate>;

TextTable by_name(const std::string& title,
                  const std::string& head,
                  const std::vector<Contestant>& contestants,
                  const std::function<const RatesByName&(const Rates&)>& part) {
  TextTable table{.title = title, .rows = {{head}}};
  std::set<std::string> names;
  for (const Contestant& each : contestants) {
    table.rows.front().push_back(each.name);
    for (const auto& [name, rate] : part(each.rates)) {
      names.insert(name);
    }
  }
  for (const std::string& name : names) {
    std::vector<std::string> cells{name};
    for (const Contestant& each : contestants) {
      const auto found = part(each.rates).find(name);
      const Rate rate = found == part(each.rates).end() ? Rate{} : found->second;
      cells.push_back(fmt::format("{}/{}", rate.k, rate.n));
    }
    table.rows.push_back(std::move(cells));
  }
  return table;
}

/// Characters, not bytes.
std::size_t width(const std::string& text) {
  return static_cast<std::size_t>(std::count_if(text.begin(), text.end(), [](char c) {
    return (static_cast<unsigned char>(c) & 0xC0U) != 0x80U;
  }));
}

std::vector<std::size_t> widths_of(const TextTable& table) {
  std::vector<std::size_t> widths(table.rows.front().size(), 0);
  for (const auto& row : table.rows) {
    for (std::size_t i = 0; i < row.size(); ++i) {
      widths[i] = std::max(widths[i], width(row[i]));
    }
  }
  return widths;
}

}  // namespace

std::vector<TextTable> tables_of(const std::vector<Contestant>& contestants) {
  std::vector<TextTable> tables{figures(contestants)};
  const auto add = [&](const char* title, const char* head, auto part) {
    TextTable table = by_name(title, head, contestants, part);
    if (table.rows.size() > 1) tables.push_back(std::move(table));
  };
  add("One effect from 2 % of DNR, kind by kind: right name and axis", "kind",
      [](const Rates& r) -> const RatesByName& { return r.by_kind; });
  add("Outside the vocabulary: flagged", "device",
      [](const Rates& r) -> const RatesByName& { return r.strangers; });
  add("Nasty cases: the right answer", "sort",
      [](const Rates& r) -> const RatesByName& { return r.nasty; });
  add("No effect: kept silent", "sort",
      [](const Rates& r) -> const RatesByName& { return r.null_sorts; });
  return tables;
}

std::string text_of(const TextTable& table, TableStyle style) {
  const std::vector<std::size_t> widths = widths_of(table);
  const bool markdown = style == TableStyle::markdown;
  std::string text = (markdown ? "**" + table.title + "**\n" : table.title) + "\n";
  for (std::size_t k = 0; k < table.rows.size(); ++k) {
    std::string line = markdown ? "|" : "";
    std::string rule = line;
    for (std::size_t i = 0; i < table.rows[k].size(); ++i) {
      const std::string& cell = table.rows[k][i];
      const std::string padded = cell + std::string(widths[i] - width(cell), ' ');
      line += markdown ? " " + padded + " |" : padded + "  ";
      rule += markdown ? "---|" : std::string(widths[i], '-') + "  ";
    }
    text += line.substr(0, line.find_last_not_of(' ') + 1) + "\n";
    if (k == 0) text += rule.substr(0, rule.find_last_not_of(' ') + 1) + "\n";
  }
  return text + "\n";
}

}  // namespace teleop
