#include "scenarios/scoring/rates.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <boost/math/special_functions/beta.hpp>

namespace teleop {
namespace {

constexpr double kConfidence = 0.95;
constexpr double kVisible = 0.02;
constexpr double kObvious = 0.10;

void count_single(const CaseScore& score, Rates& rates) {
  for (BandRates& band : rates.bands) {
    if (score.dnr < band.dnr_min || score.dnr >= band.dnr_max) continue;
    band.detected.count(score.detected);
    band.right.count(score.right);
    band.in_set.count(score.in_set);
    band.wrong_name.count(score.wrong_name);
    band.silent.count(score.silent);
    if (score.axis) band.axis.count(*score.axis);
    band.channel.count(score.channel);
  }
  if (score.dnr >= kVisible) rates.by_kind[score.kind].count(score.right);
}

void count_content(const CaseScore& score, Rates& rates) {
  switch (score.content) {
    case Content::nothing:
      rates.false_discoveries.count(score.detected || score.missing);
      if (score.group == "null") rates.null_sorts[score.sort].count(score.good());
      return;
    case Content::one:
      count_single(score, rates);
      break;
    case Content::several:
      rates.pairs_exact.count(score.pair_exact);
      rates.pairs_any.count(score.pair_any);
      rates.pairs_wrong_name.count(score.wrong_name);
      break;
    case Content::stranger:
      rates.flagged.count(score.flagged);
      rates.misnamed.count(score.misnamed);
      if (score.group != "nasty") rates.strangers[score.sort].count(score.flagged);
      return;
  }
  rates.false_flags.count(score.false_flag);
}

}  // namespace

std::optional<double> Rate::value() const noexcept {
  if (n == 0) return std::nullopt;
  return static_cast<double>(k) / static_cast<double>(n);
}

double Rate::upper95() const {
  if (k >= n) return 1.0;
  return boost::math::ibeta_inv(static_cast<double>(k) + 1.0, static_cast<double>(n - k),
                                kConfidence);
}

double Rate::lower95() const {
  if (k == 0) return 0.0;
  return boost::math::ibeta_inv(static_cast<double>(k), static_cast<double>(n - k) + 1.0,
                                1.0 - kConfidence);
}

Spread spread_of(std::vector<double> values) {
  if (values.empty()) return {};
  std::sort(values.begin(), values.end());
  const auto quantile = [&](double share) {
    const double place = share * static_cast<double>(values.size() - 1);
    const auto low = static_cast<std::size_t>(place);
    const std::size_t high = std::min(low + 1, values.size() - 1);
    return values[low] + (place - static_cast<double>(low)) * (values[high] - values[low]);
  };
  return {.n = values.size(), .median = quantile(0.5), .p90 = quantile(0.9)};
}

Calibration calibration_of(const std::vector<CaseScore::Claim>& claims) {
  struct Bin {
    double confidence = 0.0;
    double holds = 0.0;
  };
  std::array<Bin, 10> bins{};
  Calibration result{.n = claims.size()};
  if (claims.empty()) return result;
  for (const CaseScore::Claim& claim : claims) {
    const double truth = claim.holds ? 1.0 : 0.0;
    Bin& bin = bins.at(std::min<std::size_t>(static_cast<std::size_t>(claim.confidence * 10.0), 9));
    bin.confidence += claim.confidence;
    bin.holds += truth;
    result.brier += std::pow(claim.confidence - truth, 2.0);
  }
  const auto n = static_cast<double>(claims.size());
  for (const Bin& bin : bins) {
    result.ece += std::abs(bin.confidence - bin.holds) / n;
  }
  result.brier /= n;
  return result;
}

Rates rates_of(const std::vector<ScoredCase>& cases) {
  Rates rates;
  rates.bands = {BandRates{.dnr_min = kObvious, .dnr_max = std::numeric_limits<double>::infinity()},
                 BandRates{.dnr_min = kVisible, .dnr_max = kObvious},
                 BandRates{.dnr_min = 0.0, .dnr_max = kVisible}};
  std::vector<CaseScore::Claim> claims;
  std::vector<double> errors;
  std::vector<double> over_floor;
  std::vector<double> held_out;
  for (const auto& [score, ratio] : cases) {
    rates.missing.count(score.missing);
    count_content(score, rates);
    if (score.group == "nasty") rates.nasty[score.sort].count(score.good());
    claims.insert(claims.end(), score.claims.begin(), score.claims.end());
    for (const CaseScore::ParameterError& each : score.parameters) {
      if (each.covered) rates.covered_all.count(*each.covered);
      if (score.dnr < kVisible) continue;
      errors.push_back(each.relative);
      if (each.covered) rates.covered.count(*each.covered);
    }
    if (score.over_floor && score.content != Content::nothing) {
      over_floor.push_back(*score.over_floor);
    }
    if (ratio && score.content != Content::stranger) held_out.push_back(*ratio);
  }
  rates.parameter_error = spread_of(std::move(errors));
  rates.calibration = calibration_of(claims);
  rates.over_floor = spread_of(std::move(over_floor));
  rates.held_out = spread_of(std::move(held_out));
  return rates;
}

}  // namespace teleop
