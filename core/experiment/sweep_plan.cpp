#include "core/experiment/sweep_plan.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>
#include <variant>

#include <fmt/format.h>

#include "core/base/contract.hpp"
#include "core/base/error.hpp"
#include "core/base/version.hpp"
#include "core/effects/text_file.hpp"
#include "core/experiment/sweep_axis.hpp"
#include "core/math/random.hpp"

namespace teleop {
namespace {

constexpr std::size_t kMostPoints = 1'000'000;

[[noreturn]] void refuse(const std::string& place, const std::string& why) {
  throw ConfigError{fmt::format("{}: {}", place, why)};
}

/// FNV-1a, 64 bits: tells files apart, keeps nobody out.
class Fingerprint {
 public:
  void add(std::string_view text) noexcept {
    for (const char c : text) {
      hash_ = (hash_ ^ static_cast<unsigned char>(c)) * 0x100000001b3U;
    }
    hash_ = (hash_ ^ 0xffU) * 0x100000001b3U;  // where one text ends
  }
  [[nodiscard]] std::string text() const { return fmt::format("{:016x}", hash_); }

 private:
  std::uint64_t hash_ = 0xcbf29ce484222325U;
};

/// The plants of a scenario, their arms included.
void add_plants(const Scenario& scenario, Fingerprint& fingerprint) {
  namespace fs = std::filesystem;
  for (const PlantSpec* plant : {&scenario.plant(), &scenario.slave_plant()}) {
    fingerprint.add(to_toml(*plant));
    const fs::path arm = plant->arm.ends_with(".toml") ? fs::path{plant->arm}
                                                       : fs::path{"arms"} / (plant->arm + ".toml");
    fingerprint.add(read_text(data_file(arm), "arm file"));
  }
}

/// Files that a scenario names besides, such as the trace of a hand.
void add_files(const Scenario& scenario, Fingerprint& fingerprint) {
  for (const Setting& setting : scenario.settings().list()) {
    const auto* const* text = std::get_if<std::string*>(&setting.target);
    std::error_code error;
    if (text != nullptr && std::filesystem::is_regular_file(**text, error)) {
      fingerprint.add(read_text(**text, "file"));
    }
  }
}

bool is_whole(const Scenario& scenario, const std::string& key) {
  const auto& list = scenario.settings().list();
  return std::any_of(list.begin(), list.end(), [&](const Setting& setting) {
    return setting.key == key && (std::holds_alternative<int*>(setting.target) ||
                                  std::holds_alternative<std::uint64_t*>(setting.target));
  });
}

/// Puts the values of a grid's or list's axis at equal shares of its range.
void spread_evenly(SweepTable::Axis& axis) {
  if (!axis.range) return;
  if (axis.points < 2) refuse(axis.axis.place, "sweep.axis: a range needs points = 2 or more");
  for (std::int64_t i = 0; i < axis.points; ++i) {
    const double u = static_cast<double>(i) / static_cast<double>(axis.points - 1);
    axis.axis.values.push_back(sweep_value(at_share(axis, u)));
  }
}

/// One value a point: each of n equal strata is met once, in an order that is this axis' own.
void spread_hypercube(SweepTable::Axis& axis, std::size_t n, Random& random, bool whole) {
  if (axis.points != 0) {
    refuse(axis.axis.place, "sweep.axis.points: a Latin hypercube has its points in [sweep]");
  }
  std::vector<std::size_t> order(n);
  std::iota(order.begin(), order.end(), std::size_t{0});
  for (std::size_t i = n; i > 1; --i) {
    std::swap(order[i - 1], order[random.bits() % i]);
  }
  std::vector<SweepValue> values;
  for (const std::size_t stratum : order) {
    const double u = (static_cast<double>(stratum) + random.uniform()) / static_cast<double>(n);
    if (axis.range) {
      const double value = at_share(axis, u);
      values.push_back(sweep_value(whole ? std::round(value) : value));
    } else {
      const auto listed = static_cast<double>(axis.axis.values.size());
      values.push_back(axis.axis.values[static_cast<std::size_t>(u * listed)]);
    }
  }
  axis.axis.values = std::move(values);
}

/// @throws ConfigError when a key is there twice or cannot be swept.
std::set<std::string> swept_keys(const SweepTable& table) {
  std::set<std::string> seen;
  for (const SweepTable::Axis& axis : table.axes) {
    for (const std::string& key : axis.axis.keys) {
      if (!seen.insert(key).second) {
        refuse(axis.axis.place, fmt::format("sweep.axis: '{}' is swept twice", key));
      }
      if (key == "device") refuse(axis.axis.place, "sweep.axis: the device cannot be swept");
    }
  }
  return seen;
}

/// How many points the axes make together.
std::size_t count_points(const SweepTable& table) {
  if (table.method == SweepPlan::Method::latin_hypercube) {
    if (table.points == 0) refuse(table.place, "sweep: a Latin hypercube needs points = ...");
    return static_cast<std::size_t>(table.points);
  }
  if (table.points != 0) refuse(table.place, "sweep.points: only a Latin hypercube has it");
  std::size_t size = 1;
  for (const SweepTable::Axis& axis : table.axes) {
    const std::size_t length = axis.axis.values.size();
    if (table.method == SweepPlan::Method::grid) {
      size *= length;
    } else if (length != table.axes.front().axis.values.size()) {
      refuse(axis.axis.place,
             fmt::format("sweep.axis: {} values, the first axis of the list has {}", length,
                         table.axes.front().axis.values.size()));
    } else {
      size = length;
    }
    if (size > kMostPoints) refuse(table.place, "sweep: more than a million points");
  }
  return size;
}

}  // namespace

SweepPlan::SweepPlan(ScenarioText text) : text_{std::move(text)} {
  const Scenario base{text_};
  SweepTable table = read_sweep_table(text_);
  const std::set<std::string> swept = swept_keys(table);
  method_ = table.method;
  rest_ = table.rest;
  same_seed_ = table.same_seed;
  Random random{table.seed};
  for (SweepTable::Axis& axis : table.axes) {
    if (method_ == Method::latin_hypercube) {
      const bool whole = is_whole(base, axis.axis.keys.front());
      spread_hypercube(axis, static_cast<std::size_t>(std::max<std::int64_t>(table.points, 1)),
                       random, whole);
    } else {
      spread_evenly(axis);
    }
  }
  size_ = count_points(table);
  seed_is_swept_ = swept.contains("seed");
  const bool plants_are_swept = swept.contains("plant") || swept.contains("slave_plant");
  for (SweepTable::Axis& axis : table.axes) {
    axes_.push_back(std::move(axis.axis));
  }
  scenario_seed_ = base.seed();

  Fingerprint fingerprint;
  fingerprint.add(kVersion);
  fingerprint.add(text_.toml);
  add_plants(base, fingerprint);
  add_files(base, fingerprint);
  for (std::size_t index = 0; index < size_; ++index) {
    const Scenario scenario{text_, overrides(index)};
    if (plants_are_swept) add_plants(scenario, fingerprint);
  }
  fingerprint_ = fingerprint.text();
}

const SweepValue& SweepPlan::value(std::size_t axis, std::size_t index) const {
  expects(index < size_, "a point of the sweep");
  if (method_ != Method::grid) return axes_[axis].values[index];
  std::size_t stride = 1;  // the last axis changes fastest
  for (std::size_t i = axis + 1; i < axes_.size(); ++i) {
    stride *= axes_[i].values.size();
  }
  return axes_[axis].values[index / stride % axes_[axis].values.size()];
}

std::uint64_t SweepPlan::seed(std::size_t index) const {
  if (same_seed_) return scenario_seed_;
  // Below 2^52, so that every reader of JSON keeps it whole.
  Random mixed{scenario_seed_};
  Random own{mixed.bits() + index};
  return own.bits() >> 12U;
}

std::vector<Override> SweepPlan::overrides(std::size_t index) const {
  std::vector<Override> list;
  if (!seed_is_swept_) {
    list.push_back({.key = "seed", .value = std::to_string(seed(index)), .origin = "sweep"});
  }
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    for (const std::string& key : axes_[i].keys) {
      list.push_back({.key = key, .value = value(i, index).toml, .origin = axes_[i].place});
    }
  }
  return list;
}

}  // namespace teleop
