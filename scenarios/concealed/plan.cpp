#include "scenarios/concealed/plan.hpp"

#include <algorithm>
#include <array>
#include <utility>

namespace teleop::concealed {
namespace {

template <class T>
void shuffle(std::vector<T>& items, Random& random) {
  for (std::size_t i = items.size(); i > 1; --i) {
    std::swap(items[i - 1], items[static_cast<std::size_t>(random.bits() % i)]);
  }
}

std::vector<std::string> names(std::span<const Kind> kinds, Random& random) {
  std::vector<std::string> result;
  result.reserve(kinds.size());
  for (const Kind& kind : kinds) {
    result.emplace_back(kind.name);
  }
  shuffle(result, random);
  return result;
}

constexpr std::array kBands{Band::obvious, Band::visible, Band::faint};

/// Four in turn of a kind: each band once, and one more.
Band single_band(std::size_t j, std::size_t kinds) {
  const std::size_t kind = j % kinds;
  const std::size_t turn = (j / kinds + kind) % 4;
  return turn < 3 ? kBands.at(turn) : kBands.at((kind + j / (4 * kinds)) % 3);
}

void add_singles(std::vector<Slot>& slots, std::size_t number, Random& random) {
  const std::vector<std::string> kinds = names(vocabulary(), random);
  for (std::size_t j = 0; j < number; ++j) {
    slots.push_back({.group = Group::single,
                     .sort = kinds[j % kinds.size()],
                     .band = single_band(j, kinds.size())});
  }
}

/// Two effects that cannot be told from one, or that one axis cannot have at once.
bool clash(const std::string& a, const std::string& b) {
  static const std::vector<std::vector<std::string>> families{
      {"actuation_delay", "sensor_delay", "amplifier_lag"},
      {"torque_gain", "encoder_scale", "added_inertia", "time_base", "thermal_derating"},
      {"coulomb_friction", "stribeck_friction", "presliding_hysteresis", "torque_bias"},
      {"cable_spring", "torque_bias", "base_tilt", "encoder_eccentricity"},
      {"backlash", "transmission_compliance"},
      {"payload", "hand_impedance", "added_inertia"},
  };
  return a == b || std::any_of(families.begin(), families.end(), [&](const auto& family) {
           return std::find(family.begin(), family.end(), a) != family.end() &&
                  std::find(family.begin(), family.end(), b) != family.end();
         });
}

void add_pairs(std::vector<Slot>& slots, std::size_t number, Random& random) {
  std::vector<std::string> first = names(vocabulary(), random);
  std::vector<std::string> second = names(vocabulary(), random);
  for (std::size_t j = 0; j < number; ++j) {
    const std::string& a = first[j % first.size()];
    std::size_t partner = j;
    while (clash(a, second[partner % second.size()])) {
      ++partner;
    }
    slots.push_back({.group = Group::pair,
                     .sort = a + "+" + second[partner % second.size()],
                     .band = j % 3 == 2 ? Band::visible : Band::obvious});
    std::swap(second[partner % second.size()], second[j % second.size()]);
  }
}

void add_strangers(std::vector<Slot>& slots, std::size_t number, Random& random) {
  const std::vector<std::string> kinds = names(strangers(), random);
  for (std::size_t j = 0; j < number; ++j) {
    slots.push_back({.group = Group::out_of_vocabulary,
                     .sort = kinds[j % kinds.size()],
                     .band = (j + j / kinds.size()) % 2 == 0 ? Band::obvious : Band::visible});
  }
}

void add_sorts(std::vector<Slot>& slots, Group group, std::size_t number, Random& random) {
  std::vector<std::string> sorts = group == Group::null ? null_sorts() : nasty_sorts();
  shuffle(sorts, random);
  for (std::size_t j = 0; j < number; ++j) {
    const Band band = (j + j / sorts.size()) % 2 == 0 ? Band::obvious : Band::visible;
    slots.push_back({.group = group,
                     .sort = sorts[j % sorts.size()],
                     .band = group == Group::null ? Band::invisible : band});
  }
}

/// Shares of 20, the largest remainders rounded up.
std::array<std::size_t, 4> shares(std::size_t cases) {
  constexpr std::array<std::size_t, 4> kOf20{10, 3, 3, 4};
  std::array<std::size_t, 4> result{};
  std::array<std::pair<std::size_t, std::size_t>, 4> remainders{};
  std::size_t given = 0;
  for (std::size_t i = 0; i < result.size(); ++i) {
    result.at(i) = cases * kOf20.at(i) / 20;
    remainders.at(i) = {cases * kOf20.at(i) % 20, i};
    given += result.at(i);
  }
  std::stable_sort(remainders.begin(), remainders.end(),
                   [](const auto& a, const auto& b) { return a.first > b.first; });
  for (std::size_t i = 0; given < cases; ++i, ++given) {
    ++result.at(remainders.at(i).second);
  }
  return result;
}

}  // namespace

std::string_view name_of(Group group) noexcept {
  static constexpr std::array<std::string_view, 5> kNames{"single", "pair", "out_of_vocabulary",
                                                          "nasty", "null"};
  return kNames[static_cast<std::size_t>(group)];
}

const std::vector<std::string>& nasty_sorts() {
  static const std::vector<std::string> sorts{
      "hidden_by_loop_gain", "below_one_count",     "delay_and_compliance", "gain_and_inertia",
      "masked_coulomb",      "one_way_friction",    "heat_with_pauses",     "catch",
      "aliased_cogging",     "coupling_as_payload", "jitter_under_load",    "training_runs_only",
      "logged_current",      "cancelling_means",    "coloured_as_cogging",  "wrong_sampling_rate",
      "foreign_integrator",
  };
  return sorts;
}

const std::vector<std::string>& null_sorts() {
  static const std::vector<std::string> sorts{
      "plain",          "stronger_coloured",   "encoder_noise", "inertia_edge",
      "high_loop_gain", "coarse_motion",       "small_motion",  "other_integrator_step",
      "stronger_white", "coloured_as_cogging", "quiet",
  };
  return sorts;
}

std::vector<Slot> lay_out(const ConcealedPlan& plan) {
  Random random{plan.seed ^ 0xc0ffee1234ULL};
  std::vector<Slot> slots;
  slots.reserve(plan.cases);
  if (plan.nulls) {
    add_sorts(slots, Group::null, plan.cases, random);
  } else {
    const std::array<std::size_t, 4> number = shares(plan.cases);
    add_singles(slots, number[0], random);
    add_pairs(slots, number[1], random);
    add_strangers(slots, number[2], random);
    add_sorts(slots, Group::nasty, number[3], random);
  }
  shuffle(slots, random);
  return slots;
}

}  // namespace teleop::concealed
