#pragma once

#include <array>
#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "scenarios/scoring/score.hpp"

namespace teleop {

/// So many of so many, with one-sided bounds [Clopper 1934].
struct Rate {
  std::size_t k = 0;
  std::size_t n = 0;

  void count(bool hit) noexcept {
    ++n;
    k += hit ? 1 : 0;
  }
  /// Nothing where there are no cases.
  [[nodiscard]] std::optional<double> value() const noexcept;
  /// Below it with 95 % confidence; 1 where there are no cases.
  [[nodiscard]] double upper95() const;
  /// Above it with 95 % confidence; 0 where there are no cases.
  [[nodiscard]] double lower95() const;
};

/// Median and 90th percentile, linear between the values as numpy has them.
struct Spread {
  std::size_t n = 0;
  double median = 0.0;
  double p90 = 0.0;
};
[[nodiscard]] Spread spread_of(std::vector<double> values);

/// Stated probabilities against what came true.
struct Calibration {
  std::size_t n = 0;
  double ece = 0.0;  ///< mean distance of confidence and frequency over ten bins, by their counts
  double brier = 0.0;
};
[[nodiscard]] Calibration calibration_of(const std::vector<CaseScore::Claim>& claims);

/// Cases of one effect by how much it raises the held-out RMS.
struct BandRates {
  double dnr_min = 0.0;
  double dnr_max = 0.0;  ///< infinity: no end
  Rate detected{};
  Rate right{};
  Rate in_set{};
  Rate wrong_name{};
  Rate silent{};
  Rate axis{};
  Rate channel{};
};

/// A campaign in numbers. Cases count by what their device holds; the nasty ones among them are
/// listed by sort once more.
struct Rates {
  Rate missing{};
  Rate false_discoveries{};  ///< on devices without effects
  std::array<BandRates, 3> bands{};
  Rate pairs_exact{};
  Rate pairs_any{};
  Rate pairs_wrong_name{};
  Rate flagged{};  ///< of devices outside the vocabulary
  Rate misnamed{};
  Rate false_flags{};        ///< on cases that the vocabulary explains
  Spread parameter_error{};  ///< of effects from 2 % of DNR
  Rate covered{};            ///< by 90 % intervals, of the same effects
  Rate covered_all{};        ///< of all
  Calibration calibration{};
  Spread over_floor{};  ///< what the answers say of themselves
  Spread held_out{};    ///< RMS over that of the true model, of cases the vocabulary explains
  std::map<std::string, Rate> by_kind{};     ///< single effects from 2 % of DNR
  std::map<std::string, Rate> nasty{};       ///< by sort: the best that could be said was said
  std::map<std::string, Rate> null_sorts{};  ///< by sort: kept silent
  std::map<std::string, Rate> strangers{};   ///< by sort: flagged
};

struct ScoredCase {
  CaseScore score{};
  std::optional<double> held_out{};  ///< RMS over that of the true model, on the run held back
};

[[nodiscard]] Rates rates_of(const std::vector<ScoredCase>& cases);

}  // namespace teleop
