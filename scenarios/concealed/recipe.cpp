#include "scenarios/concealed/recipe.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "core/base/contract.hpp"

namespace teleop::concealed {
namespace {

using std::numbers::pi;

double log_uniform(Random& random, double low, double high) {
  return low * std::pow(high / low, random.uniform());
}

template <std::size_t n>
std::string_view one_of(const std::array<std::string_view, n>& names, Random& random) {
  return names.at(static_cast<std::size_t>(random.bits() % n));
}

/// What the sorts of one slot are drawn from.
struct Draw {
  const Slot& slot;
  const ArmModel& nominal;
  Random& random;

  [[nodiscard]] std::size_t axis() const {
    return static_cast<std::size_t>(random.bits() % kJoints);
  }
  [[nodiscard]] Sized sized(std::string_view kind, std::optional<std::size_t> on = {}) const {
    return {kind, on, nominal, random};
  }
  void search(Recipe& recipe, Sized effect) const {
    recipe.searched.push_back({std::move(effect), draw_target(slot.band, random)});
    recipe.band_matters = true;
  }
};

void pair(Recipe& recipe, const Draw& draw) {
  const std::size_t plus = draw.slot.sort.find('+');
  for (const std::string& kind :
       {draw.slot.sort.substr(0, plus), draw.slot.sort.substr(plus + 1)}) {
    const double target = draw.slot.band == Band::obvious ? log_uniform(draw.random, 0.06, 0.6)
                                                          : log_uniform(draw.random, 0.025, 0.08);
    recipe.searched.push_back({draw.sized(kind), target});
  }
}

void hidden_by_loop_gain(Recipe& recipe, const Draw& draw) {
  static constexpr std::array<std::string_view, 6> kKinds{
      "coulomb_friction", "viscous_friction", "torque_ripple",
      "cable_spring",     "torque_bias",      "presliding_hysteresis"};
  recipe.wish.loop_gain = 2.0;
  draw.search(recipe, draw.sized(one_of(kKinds, draw.random)));
}

void below_one_count(Recipe& recipe, const Draw& draw) {
  static constexpr std::array<std::string_view, 3> kKinds{"backlash", "encoder_eccentricity",
                                                          "presliding_hysteresis"};
  const std::size_t i = draw.axis();
  Effect effect = draw.sized(one_of(kKinds, draw.random), i).at(1.0);
  const double angle =
      draw.random.uniform(0.5, 0.95) * count_rad(draw.nominal)[static_cast<Eigen::Index>(i)];
  if (effect.kind == "backlash") {
    effect.at("gap") = angle;
  } else if (effect.kind == "encoder_eccentricity") {
    effect.at("amplitude") = angle;
    effect.at("cycles_per_joint_rev") = draw.nominal.parameters().transmission_ratio.at(i);
  } else {
    effect.at("level") = log_uniform(draw.random, 4e-4, 4e-3);
    effect.at("stiffness") = effect.at("level") / angle;
  }
  recipe.fixed.push_back(effect);
}

void delay_and_compliance(Recipe& recipe, const Draw& draw) {
  const std::size_t i = draw.axis();
  const double target = draw_target(draw.slot.band, draw.random);
  recipe.searched.push_back({draw.sized("actuation_delay", i), target});
  recipe.searched.push_back({draw.sized("transmission_compliance", i), target});
}

void gain_and_inertia(Recipe& recipe, const Draw& draw) {
  // On axis 1, without weight, the two are no different from neither.
  const std::size_t i = 1 + static_cast<std::size_t>(draw.random.bits() % 2);
  const double share = draw.random.uniform(0.04, 0.06);
  Effect gain = draw.sized("torque_gain", i).at(1.0);
  gain.at("gain") = 1.0 + share;
  Effect inertia = draw.sized("added_inertia", i).at(1.0);
  inertia.at("inertia") = share * (i == 1 ? draw.nominal.lumped().M22 : draw.nominal.lumped().M33);
  recipe.fixed = {gain, inertia};
}

void heat_with_pauses(Recipe& recipe, const Draw& draw) {
  using enum Movement;
  recipe.wish.movements = {reaching, pulses, reaching, pulses, hand, reaching};
  Sized heat = draw.sized("thermal_derating");
  heat.shape().at("time_constant") = draw.random.uniform(0.5, 1.5);
  draw.search(recipe, heat);
}

/// A movement that passes one period of the ripple to and fro has its harmonics.
void aliased_cogging(Recipe& recipe, const Draw& draw) {
  using enum Movement;
  const std::size_t i = draw.axis();
  recipe.wish.movements = {circles, sweeps, circles, triangles, circles, sweeps};
  recipe.wish.motion = 0.75;
  Sized ripple = draw.sized("torque_ripple", i);
  ripple.shape().at("period") = 2.0 * pi / draw.nominal.parameters().transmission_ratio.at(i);
  draw.search(recipe, ripple);
}

void coupling_as_payload(Recipe& recipe, const Draw& draw) {
  const std::size_t to = 1 + static_cast<std::size_t>(draw.random.bits() % 2);
  Sized coupling = draw.sized("axis_coupling", to);
  coupling.shape().at("from_axis") = to == 1 ? 3.0 : 2.0;
  draw.search(recipe, coupling);
}

void training_runs_only(Recipe& recipe, const Draw& draw) {
  const std::span<const Kind> kinds = vocabulary();
  Sized effect = draw.sized(kinds[draw.random.bits() % kinds.size()].name);
  effect.shape().training_only = true;
  draw.search(recipe, effect);
}

void wrong_sampling_rate(Recipe& recipe, const Draw& draw) {
  Effect clock = draw.sized("time_base").at(1.0);
  const double slip = draw.random.uniform(0.08, 0.25);
  clock.at("ratio") = draw.random.uniform() < 0.5 ? 1.0 + slip : 1.0 / (1.0 + slip);
  recipe.fixed.push_back(clock);
}

void narrow_band(Recipe& recipe, const Draw& draw) {
  recipe.wish.narrow_Nm = draw.random.uniform(6e-4, 1.5e-3);
}

void integrator(Recipe& recipe, const Draw& draw) {
  static constexpr std::array kSteps{4, 6, 10, 100};
  recipe.wish.substeps = kSteps.at(static_cast<std::size_t>(draw.random.bits() % kSteps.size()));
}

using Maker = void (*)(Recipe&, const Draw&);
struct Sort {
  std::string_view name{};
  Maker make = nullptr;
};

constexpr std::array<Sort, 27> kSorts{{
    {"hidden_by_loop_gain", hidden_by_loop_gain},
    {"below_one_count", below_one_count},
    {"delay_and_compliance", delay_and_compliance},
    {"gain_and_inertia", gain_and_inertia},
    {"masked_coulomb",
     [](Recipe& r, const Draw& d) {
       d.search(r, d.sized("coulomb_friction"));
     }},
    {"one_way_friction",
     [](Recipe& r, const Draw& d) {
       d.search(r, d.sized("oov_one_way_friction"));
     }},
    {"heat_with_pauses", heat_with_pauses},
    {"catch",
     [](Recipe& r, const Draw& d) {
       d.search(r, d.sized("oov_catch"));
     }},
    {"aliased_cogging", aliased_cogging},
    {"coupling_as_payload", coupling_as_payload},
    {"jitter_under_load",
     [](Recipe& r, const Draw& d) {
       d.search(r, d.sized("oov_jitter_under_load"));
     }},
    {"training_runs_only", training_runs_only},
    {"logged_current",
     [](Recipe& r, const Draw& d) {
       d.search(r, d.sized("oov_logged_current"));
     }},
    {"cancelling_means",
     [](Recipe& r, const Draw& d) {
       d.search(r, d.sized("payload"));
     }},
    {"coloured_as_cogging", narrow_band},
    {"wrong_sampling_rate", wrong_sampling_rate},
    {"foreign_integrator", integrator},
    {"plain",
     [](Recipe&, const Draw&) {
     }},
    {"stronger_coloured",
     [](Recipe& r, const Draw& d) {
       r.wish.coloured = d.random.uniform(1.6, 2.6);
     }},
    {"encoder_noise",
     [](Recipe& r, const Draw&) {
       r.wish.encoder_noise = true;
     }},
    {"inertia_edge",
     [](Recipe& r, const Draw&) {
       r.wish.inertia_edge = true;
     }},
    {"high_loop_gain",
     [](Recipe& r, const Draw& d) {
       r.wish.loop_gain = d.random.uniform(1.6, 2.2);
     }},
    {"coarse_motion",
     [](Recipe& r, const Draw&) {
       r.wish.motion = 1.3;
     }},
    {"small_motion",
     [](Recipe& r, const Draw& d) {
       r.wish.motion = d.random.uniform(0.2, 0.5);
     }},
    {"other_integrator_step", integrator},
    {"stronger_white",
     [](Recipe& r, const Draw& d) {
       r.wish.white = d.random.uniform(1.8, 3.0);
     }},
    {"quiet",
     [](Recipe& r, const Draw&) {
       r.wish.white = 0.3;
       r.wish.coloured = 0.3;
     }},
}};

}  // namespace

Recipe draw_recipe(const Slot& slot, const ArmModel& nominal, Random& random) {
  Recipe recipe;
  const Draw draw{slot, nominal, random};
  switch (slot.group) {
    case Group::single:
    case Group::out_of_vocabulary:
      draw.search(recipe, draw.sized(slot.sort));
      return recipe;
    case Group::pair:
      pair(recipe, draw);
      return recipe;
    case Group::nasty:
    case Group::null:
      break;
  }
  const auto* const sort = std::find_if(kSorts.begin(), kSorts.end(),
                                        [&](const Sort& each) { return each.name == slot.sort; });
  expects(sort != kSorts.end(), "every sort of a plan has a recipe");
  sort->make(recipe, draw);
  return recipe;
}

void complete(const Slot& slot, Device& device) {
  if (slot.sort == "masked_coulomb") {
    const Effect& friction = device.effects.front();
    for (RunPlan& run : device.runs) {
      run.control.at(friction.axis.value_or(0)).friction_feed_forward = friction.at("level");
    }
  } else if (slot.sort == "cancelling_means") {
    const ArmParameters& arm = device.nominal.parameters();
    const double weight = device.effects.front().at("mass") * arm.gravity_m_per_s2 * arm.l1_m;
    device.effects.push_back({.kind = "torque_bias",
                              .axis = 1,
                              .parameters = {{"bias", weight * std::cos(middle_posture()[1])}}});
  }
}

}  // namespace teleop::concealed
