#include <cmath>

#include <nlohmann/json.hpp>

#include "scenarios/scoring/rate_table.hpp"

namespace teleop {
namespace {

using Json = nlohmann::ordered_json;

/// Nothing where there is no number.
Json number(bool there, double value) {
  return there && std::isfinite(value) ? Json(value) : Json(nullptr);
}

Json upper(const Rate& rate) { return number(rate.n > 0, rate.upper95()); }
Json lower(const Rate& rate) { return number(rate.n > 0, rate.lower95()); }
Json share(const Rate& rate) { return number(rate.n > 0, rate.value().value_or(0.0)); }

Json band(const BandRates& band) {
  return {{"dnr_min", band.dnr_min},
          {"dnr_max", number(true, band.dnr_max)},
          {"n", band.right.n},
          {"right", band.right.k},
          {"honest_set", band.in_set.k},
          {"wrong_name", band.wrong_name.k},
          {"silent", band.silent.k},
          {"detected", band.detected.k},
          {"axis", {{"n", band.axis.n}, {"right", band.axis.k}}},
          {"channel", band.channel.k},
          {"right_lower95", lower(band.right)},
          {"wrong_name_upper95", upper(band.wrong_name)}};
}

Json spread(const Spread& spread) {
  return {{"n", spread.n},
          {"median", number(spread.n > 0, spread.median)},
          {"p90", number(spread.n > 0, spread.p90)}};
}

Json by_name(const std::map<std::string, Rate>& rates) {
  Json list = Json::object();
  for (const auto& [name, rate] : rates) {
    list[name] = {{"n", rate.n}, {"right", rate.k}};
  }
  return list;
}

}  // namespace

Json json_of(const Rates& rates) {
  Json bands = Json::array();
  for (const BandRates& each : rates.bands) {
    bands.push_back(band(each));
  }
  return {{"missing", rates.missing.k},
          {"nulls",
           {{"n", rates.false_discoveries.n},
            {"false", rates.false_discoveries.k},
            {"upper95", upper(rates.false_discoveries)}}},
          {"bands", bands},
          {"pairs",
           {{"n", rates.pairs_exact.n},
            {"exact", rates.pairs_exact.k},
            {"at_least_one", rates.pairs_any.k},
            {"wrong_name", rates.pairs_wrong_name.k},
            {"exact_lower95", lower(rates.pairs_exact)}}},
          {"out_of_vocabulary",
           {{"n", rates.flagged.n},
            {"flagged", rates.flagged.k},
            {"misnamed", rates.misnamed.k},
            {"flagged_lower95", lower(rates.flagged)},
            {"misnamed_upper95", upper(rates.misnamed)}}},
          {"false_flags",
           {{"n", rates.false_flags.n},
            {"false", rates.false_flags.k},
            {"upper95", upper(rates.false_flags)}}},
          {"parameter_error", spread(rates.parameter_error)},
          {"coverage_90", share(rates.covered)},
          {"coverage_90_n", rates.covered.n},
          {"coverage_90_all", share(rates.covered_all)},
          {"held_out_over_true", spread(rates.held_out)},
          {"over_floor", spread(rates.over_floor)},
          {"ece", number(rates.calibration.n > 0, rates.calibration.ece)},
          {"brier", number(rates.calibration.n > 0, rates.calibration.brier)},
          {"by_kind", by_name(rates.by_kind)},
          {"nasty", by_name(rates.nasty)}};
}

}  // namespace teleop
